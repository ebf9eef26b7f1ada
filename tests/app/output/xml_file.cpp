// SPDX-License-Identifier: Apache-2.0
#include "app/output/xml_file.hpp"

#include <glib.h>

#include <cstring>
#include <stdexcept>

namespace sunder::test {
namespace {

using Stack = std::vector<XmlElement>;

void open_element(GMarkupParseContext*, const gchar* name, const gchar** keys, const gchar** values,
                  gpointer data, GError**) {
  XmlElement element;
  element.name = name;
  for (; *keys; ++keys, ++values) element.attributes[*keys] = *values;
  static_cast<Stack*>(data)->push_back(std::move(element));
}

void close_element(GMarkupParseContext*, const gchar*, gpointer data, GError**) {
  Stack& stack = *static_cast<Stack*>(data);
  XmlElement element = std::move(stack.back());
  stack.pop_back();
  stack.back().children.push_back(std::move(element));
}

void add_text(GMarkupParseContext*, const gchar* text, gsize length, gpointer data, GError**) {
  static_cast<Stack*>(data)->back().text.append(text, length);
}

}  // namespace

const XmlElement& XmlElement::child(std::string_view element, std::string_view key) const {
  for (const XmlElement& c : children) {
    const auto found = c.attributes.find("Name");
    if (c.name == element && (key.empty() || (found != c.attributes.end() && found->second == key)))
      return c;
  }
  throw std::runtime_error(name + " has no " + std::string(element) + " " + std::string(key));
}

std::vector<std::string> XmlElement::array_names() const {
  std::vector<std::string> names;
  for (const XmlElement& c : children) names.push_back(c.attributes.at("Name"));
  return names;
}

XmlElement parse_xml(const std::string& text) {
  const GMarkupParser parser{open_element, close_element, add_text, nullptr, nullptr};
  Stack stack(1);
  GMarkupParseContext* context =
      g_markup_parse_context_new(&parser, GMarkupParseFlags{}, &stack, nullptr);
  GError* error = nullptr;
  const bool parsed = g_markup_parse_context_parse(context, text.data(),
                                                   static_cast<gssize>(text.size()), &error) &&
                      g_markup_parse_context_end_parse(context, &error);
  g_markup_parse_context_free(context);
  if (!parsed) {
    const std::string message = error->message;
    g_error_free(error);
    throw std::runtime_error("not well-formed: " + message);
  }
  return stack.front().children.at(0);
}

std::string decode_array(const XmlElement& array) {
  if (array.attributes.at("format") != "binary") throw std::runtime_error("not a binary array");
  gsize length = 0;
  guchar* bytes = g_base64_decode(array.text.c_str(), &length);
  std::string decoded(reinterpret_cast<const char*>(bytes), length);
  g_free(bytes);
  std::uint64_t stated = 0;
  std::memcpy(&stated, decoded.data(), sizeof stated);
  if (stated != decoded.size() - sizeof stated) throw std::runtime_error("wrong array length");
  return decoded.substr(sizeof stated);
}

}  // namespace sunder::test
