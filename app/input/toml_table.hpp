// SPDX-License-Identifier: Apache-2.0
// A table of a TOML file, read strictly: a key that the schema does not know is an error, every
// value has one type, every error names file:line:column (or the --set text), key and value.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/input/toml.hpp"
#include "sunder/error.hpp"
#include "sunder/types.hpp"

namespace sunder::app {

class TomlTable {
 public:
  /// `file` begins messages, `path` is the table's key path ("" for the root). Throws InputError
  /// when the table has a key that is not among `allowed`.
  TomlTable(const toml::table& table, std::string file, std::string path,
            std::vector<std::string> allowed);

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  [[nodiscard]] const std::string& path() const { return path_; }

  // Absent keys give nullopt or null; a value of another type is an InputError.
  [[nodiscard]] std::optional<double> number(std::string_view key) const;  ///< finite
  [[nodiscard]] std::optional<bool> boolean(std::string_view key) const;
  [[nodiscard]] std::optional<int> integer(std::string_view key, int least, int most) const;
  [[nodiscard]] std::optional<std::string> text(std::string_view key) const;
  [[nodiscard]] std::optional<Vec3> vec3(std::string_view key) const;
  /// An array of exactly `count` points [x, y, z].
  /// Two or more.
  [[nodiscard]] std::optional<std::vector<Vec3>> curve(std::string_view key) const;
  [[nodiscard]] std::optional<std::vector<Vec3>> points(std::string_view key,
                                                        std::size_t count) const;
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key,
                                                           std::size_t count) const;
  [[nodiscard]] std::optional<std::vector<Index>> ids(std::string_view key) const;
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::string_view key) const;
  [[nodiscard]] const toml::table* table(std::string_view key) const;
  /// Array of tables; empty when absent.
  [[nodiscard]] std::vector<const toml::table*> tables(std::string_view key) const;

  /// One table, or an array of them; empty when absent.
  [[nodiscard]] std::vector<const toml::table*> table_or_tables(std::string_view key) const;

  /// The place of the word among `known`; an unknown word is an error that lists them.
  [[nodiscard]] std::optional<int> word(std::string_view key,
                                        const std::vector<std::string>& known) const;

  template <class Value>
  [[nodiscard]] Value require(std::string_view key, std::optional<Value> value) const {
    if (!value) fail_missing(key);
    return *std::move(value);
  }

  /// "file:line:column" of a key's value, or of the table when the key is absent.
  [[nodiscard]] std::string where(std::string_view key = {}) const;
  [[nodiscard]] std::string full(std::string_view key) const;
  [[noreturn]] void fail(InputFault fault, std::string_view key, const std::string& rest) const;
  [[noreturn]] void fail_missing(std::string_view key) const;

 private:
  [[noreturn]] void fail_type(std::string_view key, const toml::node& node,
                              const std::string& expected) const;
  [[noreturn]] void fail_unknown_key(const toml::key& key) const;
  [[noreturn]] void fail_unknown_word(std::string_view key, const std::string& word,
                                      const std::vector<std::string>& known) const;
  [[nodiscard]] const toml::array* array(std::string_view key, const std::string& expected) const;
  [[nodiscard]] double finite(const toml::node& node, std::string_view key,
                              const std::string& expected) const;
  [[nodiscard]] Vec3 point(const toml::node& node, std::string_view key,
                           const std::string& expected) const;
  [[nodiscard]] std::string at(const toml::source_region& region) const;

  const toml::table& table_;
  std::string file_;
  std::string path_;
  std::vector<std::string> allowed_;
};

/// "file:line:column", the file alone when the region has no line, or the option that made it.
[[nodiscard]] std::string location(const toml::source_region& region, const std::string& file);

/// `path.key`, the key in quotes where TOML wants it so ("", "a b").
[[nodiscard]] std::string key_path(const std::string& path, std::string_view key);

/// `the string "abc"`, `the integer 3`, `an array of 2`, ...: what a value is, shortened.
[[nodiscard]] std::string describe(const toml::node& node);

}  // namespace sunder::app
