// SPDX-License-Identifier: Apache-2.0
#include "app/input/toml_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/input/nearest.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

std::string printed(const toml::node& node) {
  std::ostringstream out;
  if (node.is_integer()) out << *node.as_integer();
  if (node.is_floating_point()) out << in_digits(node.as_floating_point()->get());
  return out.str();
}

constexpr std::size_t kLongestOverride = 120;  // bytes shown

/// A key path in quotes, unless it has them already.
std::string quoted_path(const std::string& path) {
  return path.find('"') == std::string::npos ? in_quotes(path, 200) : path;
}

}  // namespace

std::string location(const toml::source_region& region, const std::string& file) {
  // Of an option: an override.
  if (region.path && region.path->starts_with("--"))
    return shortened(*region.path, kLongestOverride);
  if (region.begin.line == 0) return file;
  return file + ":" + std::to_string(region.begin.line) + ":" + std::to_string(region.begin.column);
}

std::string key_path(const std::string& path, std::string_view key) {
  constexpr std::string_view bare =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  const bool plain =
      !key.empty() && key.size() <= 60 && key.find_first_not_of(bare) == std::string_view::npos;
  return (path.empty() ? "" : path + ".") + (plain ? std::string(key) : in_quotes(key));
}

std::string describe(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array of " + std::to_string(node.as_array()->size());
    case toml::node_type::string:
      return "the string " + in_quotes(node.as_string()->get());
    case toml::node_type::integer:
      return "the integer " + printed(node);
    case toml::node_type::floating_point:
      return "the number " + printed(node);
    case toml::node_type::boolean:
      return node.as_boolean()->get() ? "the boolean true" : "the boolean false";
    default:
      return "a date or time";
  }
}

TomlTable::TomlTable(const toml::table& table, std::string file, std::string path,
                     std::vector<std::string> allowed)
    : table_(table), file_(std::move(file)), path_(std::move(path)), allowed_(std::move(allowed)) {
  for (const auto& [key, node] : table_) {
    if (std::find(allowed_.begin(), allowed_.end(), key.str()) == allowed_.end())
      fail_unknown_key(key);
  }
}

std::string TomlTable::full(std::string_view key) const {
  return key.empty() ? path_ : key_path(path_, key);
}

std::string TomlTable::at(const toml::source_region& region) const {
  return location(region, file_);
}

std::string TomlTable::where(std::string_view key) const {
  const toml::node* node = key.empty() ? nullptr : table_.get(key);
  return at(node ? node->source() : table_.source());
}

void TomlTable::fail(InputFault fault, std::string_view key, const std::string& rest) const {
  throw InputError(fault, where(key) + ": " + full(key) + " " + rest);
}

void TomlTable::fail_missing(std::string_view key) const {
  throw InputError(InputFault::missing_key, where() + ": the key " + quoted_path(full(key)) +
                                                " is missing" +
                                                (path_.empty() ? "" : " in " + path_));
}

void TomlTable::fail_type(std::string_view key, const toml::node& node,
                          const std::string& expected) const {
  throw InputError(InputFault::wrong_type, at(node.source()) + ": " + full(key) + " takes " +
                                               expected + ", not " + describe(node));
}

void TomlTable::fail_unknown_key(const toml::key& key) const {
  const std::string name(key.str());
  const std::string close = nearest(name, allowed_);
  throw InputError(InputFault::unknown_key,
                   at(key.source()) + ": unknown key " + quoted_path(key_path(path_, name)) +
                       (close.empty() ? "" : ", did you mean " + in_quotes(close) + "?") +
                       (close.empty() ? "; allowed" : " Allowed") +
                       (path_.empty() ? "" : " in " + path_) + ": " + quoted_list(allowed_, "and"));
}

void TomlTable::fail_unknown_word(std::string_view key, const std::string& word,
                                  const std::vector<std::string>& known) const {
  fail(InputFault::unknown_key, key, "is " + in_quotes(word) + "; allowed: " + quoted_list(known));
}

double TomlTable::finite(const toml::node& node, std::string_view key,
                         const std::string& expected) const {
  const std::optional<double> value = node.value<double>();
  if (!node.is_number() || !value) fail_type(key, node, expected);
  if (!std::isfinite(*value)) {
    throw InputError(InputFault::out_of_range, at(node.source()) + ": " + full(key) + " contains " +
                                                   printed(node) + "; allowed: finite numbers");
  }
  return *value;
}

std::optional<double> TomlTable::number(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (!node) return std::nullopt;
  return finite(*node, key, "a number");
}

std::optional<bool> TomlTable::boolean(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (!node) return std::nullopt;
  if (!node->is_boolean()) fail_type(key, *node, "true or false");
  return node->as_boolean()->get();
}

std::optional<int> TomlTable::integer(std::string_view key, int least, int most) const {
  const toml::node* node = table_.get(key);
  if (!node) return std::nullopt;
  if (!node->is_integer()) fail_type(key, *node, "an integer");
  const std::int64_t value = node->as_integer()->get();
  if (value < least || value > most) {
    fail(InputFault::out_of_range, key,
         "is " + std::to_string(value) + "; allowed: " + std::to_string(least) + " to " +
             std::to_string(most));
  }
  return static_cast<int>(value);
}

std::optional<std::string> TomlTable::text(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (!node) return std::nullopt;
  if (!node->is_string()) fail_type(key, *node, "a string");
  return node->as_string()->get();
}

std::optional<int> TomlTable::word(std::string_view key,
                                   const std::vector<std::string>& known) const {
  const std::optional<std::string> given = text(key);
  if (!given) return std::nullopt;
  const auto found = std::find(known.begin(), known.end(), *given);
  if (found == known.end()) fail_unknown_word(key, *given, known);
  return static_cast<int>(found - known.begin());
}

const toml::array* TomlTable::array(std::string_view key, const std::string& expected) const {
  const toml::node* node = table_.get(key);
  if (node && !node->is_array()) fail_type(key, *node, expected);
  return node ? node->as_array() : nullptr;
}

Vec3 TomlTable::point(const toml::node& node, std::string_view key,
                      const std::string& expected) const {
  const toml::array* array = node.as_array();
  if (!array || array->size() != 3) fail_type(key, node, expected);
  Vec3 result;
  for (int i = 0; i < 3; ++i)
    result[i] = finite((*array)[static_cast<std::size_t>(i)], key, expected);
  return result;
}

std::optional<Vec3> TomlTable::vec3(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (!node) return std::nullopt;
  return point(*node, key, "3 numbers [x, y, z]");
}

std::optional<std::vector<Vec3>> TomlTable::points(std::string_view key, std::size_t count) const {
  const std::string expected = std::to_string(count) + " points [[x, y, z], [x, y, z]]";
  const toml::array* values = array(key, expected);
  if (!values) return std::nullopt;
  if (values->size() != count) fail_type(key, *values, expected);
  std::vector<Vec3> result;
  for (const toml::node& value : *values) result.push_back(point(value, key, expected));
  return result;
}

std::optional<std::vector<Vec3>> TomlTable::curve(std::string_view key) const {
  const std::string expected = "2 or more points [[x, y, z], [x, y, z], ...]";
  const toml::array* values = array(key, expected);
  if (!values) return std::nullopt;
  if (values->size() < 2) fail_type(key, *values, expected);
  std::vector<Vec3> result;
  for (const toml::node& value : *values) result.push_back(point(value, key, expected));
  return result;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key,
                                                      std::size_t count) const {
  const std::string expected = "an array of " + std::to_string(count) + " numbers";
  const toml::array* values = array(key, expected);
  if (!values) return std::nullopt;
  if (values->size() != count) fail_type(key, *values, expected);
  std::vector<double> result;
  for (const toml::node& value : *values) result.push_back(finite(value, key, expected));
  return result;
}

std::optional<std::vector<Index>> TomlTable::ids(std::string_view key) const {
  const toml::array* values = array(key, "an array of ids");
  if (!values) return std::nullopt;
  std::vector<Index> result;
  for (const toml::node& value : *values) {
    if (!value.is_integer()) fail_type(key, value, "an array of ids (integers)");
    const std::int64_t id = value.as_integer()->get();
    if (id < 0 || id > std::numeric_limits<Index>::max()) {
      throw InputError(InputFault::bad_id, at(value.source()) + ": " + full(key) +
                                               " contains the id " + std::to_string(id) +
                                               "; allowed: ids of the mesh, from 0");
    }
    result.push_back(static_cast<Index>(id));
  }
  return result;
}

std::optional<std::vector<std::string>> TomlTable::texts(std::string_view key) const {
  const toml::array* values = array(key, "an array of strings");
  if (!values) return std::nullopt;
  std::vector<std::string> result;
  for (const toml::node& value : *values) {
    if (!value.is_string()) fail_type(key, value, "an array of strings");
    result.push_back(value.as_string()->get());
  }
  return result;
}

const toml::table* TomlTable::table(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (!node) return nullptr;
  if (!node->is_table()) fail_type(key, *node, "a table [" + full(key) + "]");
  return node->as_table();
}

std::vector<const toml::table*> TomlTable::tables(std::string_view key) const {
  const std::string expected = "tables [[" + full(key) + "]]";
  std::vector<const toml::table*> result;
  const toml::array* values = array(key, expected);
  if (!values) return result;
  for (const toml::node& value : *values) {
    if (!value.is_table()) fail_type(key, value, expected);
    result.push_back(value.as_table());
  }
  return result;
}

std::vector<const toml::table*> TomlTable::table_or_tables(std::string_view key) const {
  const toml::node* node = table_.get(key);
  if (node && node->is_table()) return {node->as_table()};
  return tables(key);
}

}  // namespace sunder::app
