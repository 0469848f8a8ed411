// 8-bit sRGB pictures as PNG files, on disk or in memory.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/io/layer_colors.h"

namespace linetree {

// The bytes of the file.
absl::StatusOr<std::string> EncodePng(const Picture8& picture);

// Writes the whole file or nothing (atomic_file.h).
absl::Status WritePng(const Picture8& picture, const std::string& path);

// Reads any PNG file as 8-bit RGB. NOT_FOUND, or INVALID_ARGUMENT naming the file.
absl::StatusOr<Picture8> ReadPng(const std::string& path);

}  // namespace linetree
