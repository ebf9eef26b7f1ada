// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/parts.hpp"

#include <map>
#include <optional>
#include <regex>

#include "app/output/text.hpp"
#include "app/sweep/outcome.hpp"
#include "sunder/error.hpp"

namespace sunder::app::sweep {
namespace {

/// Of the folders' names, by i; `n` of the first one.
struct Found {
  std::map<int, std::filesystem::path> parts;
  int n = 0;
};

Found find_parts(const std::filesystem::path& folder) {
  static const std::regex name("part-([1-9][0-9]{0,8})-of-([1-9][0-9]{0,8})");
  Found found;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    std::smatch match;
    const std::string text = entry.path().filename().string();
    if (!entry.is_directory(none) || !std::regex_match(text, match, name)) continue;
    const int i = std::stoi(match[1]), n = std::stoi(match[2]);
    if (found.n != 0 && n != found.n) {
      throw UsageError(folder.string() + " holds parts of " + std::to_string(found.n) + " and of " +
                       std::to_string(n) + "; keep those of one division there");
    }
    found.n = n;
    found.parts[i] = entry.path();
  }
  return found;
}

}  // namespace

bool has_parts(const std::filesystem::path& folder) {
  try {
    return !find_parts(folder).parts.empty();
  } catch (const UsageError&) {
    return true;
  }
}

Merged merge_parts(const std::filesystem::path& folder) {
  const Found found = find_parts(folder);
  Merged merged;
  std::optional<Description> first;
  for (int i = 1; i <= found.n; ++i) {
    const std::string name = Part{i, found.n}.folder();
    const auto part = found.parts.find(i);
    const std::optional<Description> its =
        part == found.parts.end() ? std::nullopt : read_description(part->second);
    if (!its) {
      merged.missing.push_back(name + " is not there");
      continue;
    }
    if (!first) first = its;
    if (const std::string other = difference(*first, *its); !other.empty()) {
      throw UsageError((folder / name).string() +
                       " is of another sweep than the parts before: " + other);
    }
    Rows rows = read_rows(part->second, columns(its->instruments).size());
    const RunIndex all = Part{i, found.n}.count(run_count(its->axes));
    const auto done = static_cast<RunIndex>(rows.size());
    if (done < all) {
      merged.missing.push_back(name + " has " + grouped(done) + " of its " + grouped(all) +
                               " runs");
    }
    merged.rows.merge(rows);
  }
  if (!first) throw UsageError("--merge: there is no part of a sweep in " + folder.string());
  merged.sweep = *first;
  merged.sweep.part = {};
  return merged;
}

}  // namespace sunder::app::sweep
