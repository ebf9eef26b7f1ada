// SPDX-License-Identifier: Apache-2.0
#include "app/input/vtu_array.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>

#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

constexpr const char* kTruncated = "ends before its values do: the file is truncated or damaged";
constexpr std::string_view kSpace = " \t\r\n";

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/// Bytes one after the other, raw or out of base64. Padding may stand inside: VTK encodes a header
/// and its data apart.
class Bytes {
 public:
  Bytes(std::string_view from, bool base64) : from_(from), base64_(base64) {}

  /// At most so many bytes are left.
  [[nodiscard]] std::size_t left() const {
    return base64_ ? from_.size() / 4 * 3 + 3 : from_.size();
  }

  std::string take(std::uint64_t count) {
    if (count > left()) throw std::string(kTruncated);
    std::string bytes;
    bytes.reserve(static_cast<std::size_t>(count));
    if (!base64_) {
      bytes = std::string(from_.substr(0, static_cast<std::size_t>(count)));
      from_.remove_prefix(bytes.size());
      return bytes;
    }
    while (bytes.size() < count) {
      if (next_ == ready_.size()) decode_four();
      bytes += ready_[next_++];
    }
    return bytes;
  }

 private:
  void decode_four() {
    from_.remove_prefix(std::min(from_.find_first_not_of(kSpace), from_.size()));
    if (from_.size() < 4) throw std::string(kTruncated);
    const std::string_view four = from_.substr(0, 4);
    from_.remove_prefix(4);
    const std::size_t padding = four.ends_with("==") ? 2 : four.ends_with('=') ? 1 : 0;
    unsigned word = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const int value = i < 4 - padding ? base64_value(four[i]) : 0;
      if (value < 0) throw std::string("is no base64 text: the file is damaged");
      word = word << 6U | static_cast<unsigned>(value);
    }
    ready_.clear();
    next_ = 0;
    for (unsigned i = 0; i < 3 - padding; ++i)
      ready_ += static_cast<char>(word >> (16 - 8 * i) & 0xffU);
  }

  std::string_view from_;
  bool base64_;
  std::string ready_;
  std::size_t next_ = 0;
};

template <class Word>
Word word_at(const char* bytes, bool swapped) {
  std::array<char, sizeof(Word)> own{};
  std::memcpy(own.data(), bytes, sizeof(Word));
  if (swapped) std::reverse(own.begin(), own.end());
  Word word;
  std::memcpy(&word, own.data(), sizeof(Word));
  return word;
}

std::uint64_t take_length(Bytes& bytes, const VtuCoding& coding) {
  const std::string word = bytes.take(coding.header);
  return coding.header == 8 ? word_at<std::uint64_t>(word.data(), coding.swapped)
                            : word_at<std::uint32_t>(word.data(), coding.swapped);
}

/// "[blocks][bytes of a block][bytes of the last, 0: a whole one][compressed bytes of each]"
std::string inflate_blocks(Bytes& bytes, const VtuCoding& coding) {
  constexpr std::uint64_t kMostRatio = 1100;  // zlib's is 1032
  const std::uint64_t blocks = take_length(bytes, coding);
  const std::uint64_t size = take_length(bytes, coding);
  const std::uint64_t last = take_length(bytes, coding);
  if (blocks > bytes.left() / coding.header) throw std::string(kTruncated);
  std::vector<std::uint64_t> packed(static_cast<std::size_t>(blocks));
  for (std::uint64_t& p : packed) p = take_length(bytes, coding);
  std::string all;
  for (std::size_t b = 0; b < packed.size(); ++b) {
    const std::uint64_t wanted = b + 1 == packed.size() && last != 0 ? last : size;
    const std::string from = bytes.take(packed[b]);
    if (wanted > kMostRatio * (from.size() + 1))
      throw std::string("has a damaged compressed block");
    std::string block(static_cast<std::size_t>(wanted), '\0');
    uLongf length = static_cast<uLongf>(wanted);
    const int code =
        ::uncompress(reinterpret_cast<Bytef*>(block.data()), &length,
                     reinterpret_cast<const Bytef*>(from.data()), static_cast<uLong>(from.size()));
    if (code != Z_OK || length != wanted) throw std::string("has a damaged compressed block");
    all += block;
  }
  return all;
}

std::string payload(const VtuArray& array, const VtuCoding& coding) {
  const bool appended = array.format == "appended";
  std::string_view from = appended ? coding.appended : array.text;
  if (appended) {
    if (array.offset >= from.size()) throw std::string(kTruncated);
    from.remove_prefix(static_cast<std::size_t>(array.offset));
  }
  Bytes bytes(from, !appended || !coding.appended_raw);
  if (coding.compressed) return inflate_blocks(bytes, coding);
  return bytes.take(take_length(bytes, coding));
}

template <class Word, class Value>
void convert(const std::string& bytes, bool swapped, std::vector<Value>& values) {
  if (bytes.size() % sizeof(Word) != 0) throw std::string("has a part of a value at its end");
  values.reserve(bytes.size() / sizeof(Word));
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(Word))
    values.push_back(static_cast<Value>(word_at<Word>(bytes.data() + i, swapped)));
}

template <class Value>
std::vector<Value> from_words(const VtuArray& array, const VtuCoding& coding) {
  const std::string bytes = payload(array, coding);
  std::vector<Value> values;
  const auto as = [&](auto word) { convert<decltype(word)>(bytes, coding.swapped, values); };
  if (array.type == "Float64") as(double{});
  if (array.type == "Float32") as(float{});
  if (array.type == "Int64") as(std::int64_t{});
  if (array.type == "UInt64") as(std::uint64_t{});
  if (array.type == "Int32") as(std::int32_t{});
  if (array.type == "UInt32") as(std::uint32_t{});
  if (array.type == "Int16") as(std::int16_t{});
  if (array.type == "UInt16") as(std::uint16_t{});
  if (array.type == "Int8") as(std::int8_t{});
  if (array.type == "UInt8") as(std::uint8_t{});
  return values;
}

template <class Value>
std::vector<Value> from_text(std::string_view text) {
  std::vector<Value> values;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
    if (text.empty()) return values;
    const std::string_view word = text.substr(0, text.find_first_of(kSpace));
    text.remove_prefix(word.size());
    Value value{};
    const char* begin = word.data() + (word.starts_with('+') && word.size() > 1 ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      throw "holds " + in_quotes(word, 40) + " where a number should be";
    values.push_back(value);
  }
}

void check_type(const VtuArray& array) {
  constexpr std::array<std::string_view, 10> types = {"Float64", "Float32", "Int64", "UInt64",
                                                      "Int32",   "UInt32",  "Int16", "UInt16",
                                                      "Int8",    "UInt8"};
  if (std::find(types.begin(), types.end(), array.type) == types.end())
    throw "has the type " + in_quotes(array.type, 20) +
        "; allowed: Float32, Float64, Int8 to Int64 "
        "and UInt8 to UInt64";
}

template <class Value>
std::vector<Value> values_of(const VtuArray& array, const VtuCoding& coding) {
  check_type(array);
  if (array.format == "ascii") return from_text<Value>(array.text);
  if (array.format != "binary" && array.format != "appended")
    throw "has the format " + in_quotes(array.format, 20) + "; allowed: ascii, binary, appended";
  return from_words<Value>(array, coding);
}

}  // namespace

std::string VtuArray::title() const {
  return section + (name.empty() ? "" : ": " + in_quotes(name, 40));
}

bool VtuArray::integer() const { return type.find("Int") != std::string::npos; }

std::vector<double> vtu_reals(const VtuArray& array, const VtuCoding& coding) {
  return values_of<double>(array, coding);
}

std::vector<std::int64_t> vtu_integers(const VtuArray& array, const VtuCoding& coding) {
  if (!array.integer()) throw "has the type " + in_quotes(array.type, 20) + "; allowed: integers";
  return values_of<std::int64_t>(array, coding);
}

}  // namespace sunder::app
