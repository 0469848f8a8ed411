// Plain numbers as bytes, in the machine's own order: pages are read where they were written (a
// page from elsewhere has another checksum of its header, see page.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace linetree {

class ByteWriter {
 public:
  explicit ByteWriter(std::string& out) : out_(out) {}

  // T holds no padding: what it holds is written bit for bit.
  template <class T>
  void Put(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    out_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  // The number of elements, then all of them.
  template <class T>
  void PutAll(std::span<const T> values) {
    static_assert(std::is_arithmetic_v<T>);
    Put(static_cast<uint32_t>(values.size()));
    out_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }

 private:
  std::string& out_;
};

// Reads what a ByteWriter wrote. Past the end, or after Fail, everything reads as zero or empty and
// ok() is false: ask once, at the end of a thing.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T Get() {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    T value{};
    if (Has(sizeof(T))) {
      std::memcpy(&value, bytes_.data(), sizeof(T));
      bytes_.remove_prefix(sizeof(T));
    }
    return value;
  }
  // Reads a number of elements, which is at most what the rest has room for if each takes `bytes`.
  size_t GetCount(size_t bytes) {
    const auto count = Get<uint32_t>();
    return Has(count * bytes) ? count : 0;
  }
  template <class T>
  std::vector<T> GetAll() {
    const size_t count = GetCount(sizeof(T));
    std::vector<T> values(count);
    if (count == 0) return values;
    std::memcpy(values.data(), bytes_.data(), count * sizeof(T));
    bytes_.remove_prefix(count * sizeof(T));
    return values;
  }

  // Says that what was read makes no sense, unless `sense`.
  void Expect(bool sense) { ok_ = ok_ && sense; }
  bool ok() const { return ok_; }
  size_t left() const { return ok_ ? bytes_.size() : 0; }

 private:
  bool Has(size_t bytes) {
    ok_ = ok_ && bytes <= bytes_.size();
    return ok_;
  }

  std::string_view bytes_;
  bool ok_ = true;
};

}  // namespace linetree
