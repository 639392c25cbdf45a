// SPDX-License-Identifier: BSD-3-Clause
#include <cassert>
#include <csetjmp>
#include <cstddef>
#include <cstdio>  // jpeglib.h needs FILE
#include <cstdlib>

#include <jpeglib.h>

#include "datasets/files/bad_input.h"
#include "datasets/images/image_io.h"

namespace plumbline {
namespace {

// libjpeg leaves by longjmp, which runs no destructors: the functions that call it hold only plain
// values, and the pixels belong to the caller.
struct ErrorTrap {
  jpeg_error_mgr manager;
  std::jmp_buf exit;
  char message[JMSG_LENGTH_MAX];
};

void leave(j_common_ptr info) {
  auto* trap = reinterpret_cast<ErrorTrap*>(info->err);
  (*info->err->format_message)(info, trap->message);
  std::longjmp(trap->exit, 1);
}

// A warning means damaged or missing data, which libjpeg would fill with grey: a fault here.
void warn(j_common_ptr info, int level) {
  if (level < 0) leave(info);
}

struct Decoder {
  ~Decoder() { jpeg_destroy_decompress(&info); }

  jpeg_decompress_struct info;
  jpeg_progress_mgr progress;
  ErrorTrap trap;
};

// A progressive image may repeat its scans as often as it likes, each as long as a whole one;
// encoders write about ten.
constexpr int kMostScans = 200;

void refuseEndlessScans(j_common_ptr info) {
  auto* decoder = reinterpret_cast<j_decompress_ptr>(info);
  if (decoder->input_scan_number <= kMostScans) return;
  auto* trap = reinterpret_cast<ErrorTrap*>(info->err);
  std::snprintf(trap->message, sizeof trap->message, "more than %d scans", kMostScans);
  std::longjmp(trap->exit, 1);
}

bool readHeader(Decoder& decoder, const unsigned char* bytes, unsigned long size) {
  decoder.info.err = jpeg_std_error(&decoder.trap.manager);
  decoder.trap.manager.error_exit = leave;
  decoder.trap.manager.emit_message = warn;
  if (setjmp(decoder.trap.exit) != 0) return false;
  jpeg_create_decompress(&decoder.info);
  decoder.progress.progress_monitor = refuseEndlessScans;
  decoder.info.progress = &decoder.progress;
  jpeg_mem_src(&decoder.info, bytes, size);
  jpeg_read_header(&decoder.info, TRUE);
  return true;
}

bool start(Decoder& decoder) {
  if (setjmp(decoder.trap.exit) != 0) return false;
  decoder.info.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&decoder.info);
  return true;
}

bool readRows(Decoder& decoder, unsigned char* pixels) {
  if (setjmp(decoder.trap.exit) != 0) return false;
  while (decoder.info.output_scanline < decoder.info.output_height) {
    JSAMPROW row =
        pixels + static_cast<std::size_t>(decoder.info.output_scanline) * decoder.info.output_width;
    jpeg_read_scanlines(&decoder.info, &row, 1);
  }
  jpeg_finish_decompress(&decoder.info);
  return true;
}

// See ErrorTrap: compress() holds only plain values.
struct Encoder {
  ~Encoder() {
    jpeg_destroy_compress(&info);
    std::free(bytes);
  }

  jpeg_compress_struct info;
  ErrorTrap trap;
  unsigned char* bytes;
  unsigned long size;
};

bool compress(Encoder& e, const unsigned char* pixels, int width, int height, int quality) {
  e.info.err = jpeg_std_error(&e.trap.manager);
  e.trap.manager.error_exit = leave;
  if (setjmp(e.trap.exit) != 0) return false;
  jpeg_create_compress(&e.info);
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

GrayImage decodeJpeg(std::string_view bytes, const SizeCheck& check) {
  // What readHeader() makes is destroyed even where it fails; of zeros, as they are before,
  // nothing.
  Decoder decoder{};
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  if (!readHeader(decoder, data, bytes.size())) throw DecodeError{decoder.trap.message};
  check(decoder.info.image_width, decoder.info.image_height);
  // libjpeg makes no grey of inks.
  const J_COLOR_SPACE colours = decoder.info.jpeg_color_space;
  if (colours == JCS_CMYK || colours == JCS_YCCK) throw DecodeError{"is a JPEG in CMYK", true};
  if (!start(decoder)) throw DecodeError{decoder.trap.message};
  GrayImage image(static_cast<int>(decoder.info.output_width),
                  static_cast<int>(decoder.info.output_height));
  if (!readRows(decoder, image.data())) throw DecodeError{decoder.trap.message};
  return image;
}

std::string encodeJpeg(const GrayImage& image, int quality) {
  assert(!image.empty() && quality >= 1 && quality <= 100);
  Encoder encoder{};
  if (!compress(encoder, image.data(), image.width(), image.height(), quality)) {
    throw BadInput(InputFault::kUnwritable,
                   std::string("an image cannot be written as JPEG: ") + encoder.trap.message);
  }
  return {reinterpret_cast<const char*>(encoder.bytes), encoder.size};
}

}  // namespace plumbline
