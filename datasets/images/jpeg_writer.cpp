// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/images/jpeg_writer.h"

#include <cassert>
#include <csetjmp>
#include <cstddef>
#include <cstdio>  // jpeglib.h needs FILE
#include <cstdlib>

#include <jpeglib.h>

#include "calibrator/base/error.h"

namespace plumbline {
namespace {

// libjpeg leaves by longjmp, which runs no destructors: compress() holds only plain values.
struct Encoder {
  jpeg_compress_struct info;
  jpeg_error_mgr manager;
  std::jmp_buf exit;
  char message[JMSG_LENGTH_MAX];
  unsigned char* bytes;
  unsigned long size;
};

void leave(j_common_ptr info) {
  auto* encoder = static_cast<Encoder*>(info->client_data);
  (*info->err->format_message)(info, encoder->message);
  std::longjmp(encoder->exit, 1);
}

bool compress(Encoder& e, const unsigned char* pixels, int width, int height, int quality) {
  e.info.err = jpeg_std_error(&e.manager);
  e.manager.error_exit = leave;
  jpeg_create_compress(&e.info);
  e.info.client_data = &e;
  if (setjmp(e.exit) != 0) return false;
  jpeg_mem_dest(&e.info, &e.bytes, &e.size);
  e.info.image_width = static_cast<JDIMENSION>(width);
  e.info.image_height = static_cast<JDIMENSION>(height);
  e.info.input_components = 1;
  e.info.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&e.info);
  jpeg_set_quality(&e.info, quality, TRUE);
  e.info.optimize_coding = TRUE;
  jpeg_start_compress(&e.info, TRUE);
  while (e.info.next_scanline < e.info.image_height) {
    auto* row = const_cast<JSAMPROW>(pixels + static_cast<std::size_t>(e.info.next_scanline) *
                                                  static_cast<std::size_t>(width));
    jpeg_write_scanlines(&e.info, &row, 1);
  }
  jpeg_finish_compress(&e.info);
  return true;
}

}  // namespace

std::string encodeJpeg(const GrayImage& image, int quality) {
  assert(!image.empty() && quality >= 1 && quality <= 100);
  Encoder encoder{};
  const bool done = compress(encoder, image.data(), image.width(), image.height(), quality);
  std::string jpeg;
  if (done) jpeg.assign(reinterpret_cast<const char*>(encoder.bytes), encoder.size);
  jpeg_destroy_compress(&encoder.info);
  std::free(encoder.bytes);
  if (!done)
    throw InputError(std::string("an image cannot be written as JPEG: ") + encoder.message);
  return jpeg;
}

}  // namespace plumbline
