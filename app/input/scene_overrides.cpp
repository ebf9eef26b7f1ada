// SPDX-License-Identifier: Apache-2.0
#include "app/input/scene_overrides.hpp"

#include <charconv>
#include <vector>

#include "app/input/toml_guard.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

struct Segment {
  std::string text;
  bool quoted = false;
};

/// An override, with the option that it came by.
struct Override {
  const std::string& text;
  const std::string& option;
};

[[noreturn]] void fail(InputFault fault, const Override& of, const std::string& rest) {
  throw InputError(fault, of.option + " " + shortened(of.text, 120) + ": " + rest);
}

// Splits `a.0."b.c"=value`; returns the position after '='.
std::size_t split_path(const Override& of, std::vector<Segment>& path) {
  const std::string& text = of.text;
  const auto expects = "expected key.path=value, e.g. fracture.model=B";
  std::size_t i = 0;
  while (true) {
    Segment segment;
    if (i < text.size() && (text[i] == '"' || text[i] == '\'')) {
      const std::size_t end = text.find(text[i], i + 1);
      if (end == std::string::npos) fail(InputFault::syntax, of, expects);
      segment = {text.substr(i + 1, end - i - 1), true};
      i = end + 1;
    } else {
      const std::size_t end = std::min(text.find_first_of(".=", i), text.size());
      segment.text = text.substr(i, end - i);
      i = end;
    }
    if (segment.text.empty() || i >= text.size() || (text[i] != '.' && text[i] != '='))
      fail(InputFault::syntax, of, expects);
    path.push_back(segment);
    if (text[i++] == '=') return i;
  }
}

bool is_index(const Segment& segment) {
  return !segment.quoted && segment.text.find_first_not_of("0123456789") == std::string::npos;
}

std::string as_toml_string(const std::string& word) {
  std::string quoted = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

// A table with the single key "value".
toml::table parse_value(const std::string& value, const Override& of) {
  const std::string source = of.option + " " + one_line(of.text);
  try {
    if (!stray_character_line(value)) {
      toml::table parsed = toml::parse("value = " + value, source);
      if (parsed.size() == 1) return parsed;
    }
  } catch (const toml::parse_error&) {
    // fall through: a bare word
  }
  if (value.empty()) fail(InputFault::syntax, of, "the value is empty");
  if (std::string_view("[{\"'").find(value.front()) != std::string_view::npos)
    fail(InputFault::syntax, of, "the value is not valid TOML");
  try {
    return toml::parse("value = " + as_toml_string(value), source);
  } catch (const toml::parse_error& error) {
    fail(InputFault::syntax, of, std::string(error.description()));
  }
}

toml::node& element(toml::array& array, const Segment& segment, bool array_next,
                    const Override& of) {
  std::size_t index = 0;
  const char* end = segment.text.data() + segment.text.size();
  const bool ok =
      is_index(segment) && std::from_chars(segment.text.data(), end, index).ec == std::errc();
  if (!ok || index > array.size()) {
    fail(InputFault::bad_id, of,
         in_quotes(segment.text) + " is no index here; allowed: 0 to " +
             std::to_string(array.size()) + " (the last one appends)");
  }
  if (index == array.size()) {
    if (array_next)
      array.push_back(toml::array{});
    else
      array.push_back(toml::table{});
  }
  return array[index];
}

// The key carries its source, so that "unknown key" names the --set text.
toml::key sourced_key(const std::string& name, const toml::source_region& source) {
  return toml::key(name, toml::source_region(source));
}

toml::node& child(toml::node& parent, const Segment& segment, bool array_next, const Override& of,
                  const toml::source_region& source) {
  if (toml::array* array = parent.as_array()) return element(*array, segment, array_next, of);
  toml::table* table = parent.as_table();
  if (!table)
    fail(InputFault::unknown_key, of, in_quotes(segment.text) + " lies inside a plain value");
  if (!table->contains(segment.text)) {
    if (array_next)
      table->insert(sourced_key(segment.text, source), toml::array{});
    else
      table->insert(sourced_key(segment.text, source), toml::table{});
  }
  return *table->get(segment.text);
}

}  // namespace

void apply_override(toml::table& scene, const std::string& text, const std::string& option) {
  const Override of{text, option};
  std::vector<Segment> path;
  const std::size_t begin = split_path(of, path);
  toml::table parsed = parse_value(text.substr(begin), of);
  toml::node& value = *parsed.get("value");

  toml::node* parent = &scene;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    parent = &child(*parent, path[i], is_index(path[i + 1]), of, value.source());

  const Segment& last = path.back();
  if (toml::array* array = parent->as_array()) {
    element(*array, last, false, of);  // checks the index, appends when it is the next one
    std::size_t index = 0;
    std::from_chars(last.text.data(), last.text.data() + last.text.size(), index);
    value.visit([&](auto& typed) { array->replace(array->cbegin() + index, std::move(typed)); });
    return;
  }
  toml::table* table = parent->as_table();
  if (!table)
    fail(InputFault::unknown_key, of, in_quotes(last.text) + " lies inside a plain value");
  table->erase(last.text);
  toml::key key = sourced_key(last.text, value.source());
  value.visit([&](auto& typed) { table->insert(std::move(key), std::move(typed)); });
}

}  // namespace sunder::app
