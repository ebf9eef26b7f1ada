// SPDX-License-Identifier: Apache-2.0
// scene_keys SOURCE: writes the table of keys of SOURCE/docs/interface.md, SOURCE/docs/tissues.md
// and the fuzzer's dictionary SOURCE/tests/fuzz/scene.dict anew.
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>

#include "app/input/scene_key_pages.hpp"

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: scene_keys SOURCE, the folder with docs/ and tests/\n";
    return 2;
  }
  const std::string source = arguments[1], page = source + "/docs/interface.md";
  std::ifstream in(page, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::string written = sunder::test::with_key_table(text);
  std::ofstream out(page, std::ios::binary);
  std::ofstream dictionary(source + "/tests/fuzz/scene.dict", std::ios::binary);
  out << written << std::flush;
  dictionary << sunder::test::scene_dictionary() << std::flush;
  std::ofstream tissues(source + "/docs/tissues.md", std::ios::binary);
  tissues << sunder::test::tissues_page() << std::flush;
  if (out && dictionary && tissues) return 0;
  std::cerr << "scene_keys: could not write below " << source << '\n';
  return 1;
} catch (const std::exception& error) {
  std::cerr << "scene_keys: " << error.what() << '\n';
  return 1;
}
