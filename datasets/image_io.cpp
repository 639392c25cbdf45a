// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/image_io.h"

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string_view>

#include <jpeglib.h>
#include <png.h>

#include "calibrator/base/error.h"
#include "datasets/internal/mapped_file.h"

namespace plumbline {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw InputError(path, 0, "cannot be read as an image: " + why + "; copy the file again");
}

GrayImage readPng(const std::string& path, std::string_view bytes) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()) == 0) {
    refuse(path, header.message);
  }
  header.format = PNG_FORMAT_GRAY;
  GrayImage image(static_cast<int>(header.width), static_cast<int>(header.height));
  if (png_image_finish_read(&header, nullptr, image.data(), 0, nullptr) == 0) {
    png_image_free(&header);
    refuse(path, header.message);
  }
  // A warning (bit 0) is what libpng says of a damaged file that it could still fill.
  if ((header.warning_or_error & PNG_IMAGE_ERROR) != 0) refuse(path, header.message);
  return image;
}

// libjpeg reports by longjmp; nothing with a destructor may live in the frame that it leaves.
struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf escape;
  char message[JMSG_LENGTH_MAX] = "";
};

void leaveJpeg(j_common_ptr info) {
  auto* errors = reinterpret_cast<JpegErrors*>(info->err);
  (*info->err->format_message)(info, errors->message);
  std::longjmp(errors->escape, 1);  // NOLINT(cert-err52-cpp): the library's way
}

// A truncated file is only a warning to libjpeg, which fills the rest with grey; to us it is an
// error.
void warnJpeg(j_common_ptr info, int level) {
  if (level < 0) leaveJpeg(info);
}

struct JpegSource {
  std::string_view bytes;
  GrayImage* image;
};

// Decodes all rows; false with errors.message set where the file is damaged.
bool decodeJpeg(const JpegSource& source, jpeg_decompress_struct& info, JpegErrors& errors) {
  if (setjmp(errors.escape) != 0) return false;  // NOLINT(cert-err52-cpp)
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(source.bytes.data()),
               source.bytes.size());
  jpeg_read_header(&info, TRUE);
  info.out_color_space = JCS_GRAYSCALE;
  jpeg_start_decompress(&info);
  *source.image =
      GrayImage(static_cast<int>(info.output_width), static_cast<int>(info.output_height));
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = source.image->row(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return true;
}

GrayImage readJpeg(const std::string& path, std::string_view bytes) {
  GrayImage image;
  jpeg_decompress_struct info{};
  JpegErrors errors{};
  info.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = leaveJpeg;
  errors.manager.emit_message = warnJpeg;
  const bool good = decodeJpeg({bytes, &image}, info, errors);
  jpeg_destroy_decompress(&info);
  if (!good) refuse(path, errors.message);
  return image;
}

}  // namespace

GrayImage readGrayImage(const std::string& path) {
  const MappedFile file(path);
  const std::string_view bytes = file.text();
  if (bytes.substr(0, 8) == std::string_view("\x89PNG\r\n\x1a\n", 8)) return readPng(path, bytes);
  if (bytes.substr(0, 2) == "\xff\xd8") return readJpeg(path, bytes);
  refuse(path, bytes.empty() ? "it is empty" : "it is neither PNG nor JPEG");
}

void writePng(const std::string& path, const GrayImage& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.format = PNG_FORMAT_GRAY;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.flags = PNG_IMAGE_FLAG_FAST;
  const std::string temporary = path + ".tmp";
  if (png_image_write_to_file(&header, temporary.c_str(), 0, image.data(), image.width(),
                              nullptr) == 0) {
    std::remove(temporary.c_str());
    throw InputError(path, 0, std::string("cannot be written: ") + header.message);
  }
  std::filesystem::rename(temporary, path);
}

}  // namespace plumbline
