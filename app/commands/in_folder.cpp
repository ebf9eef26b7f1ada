// SPDX-License-Identifier: Apache-2.0
#include "app/commands/in_folder.hpp"

#include <utility>

namespace sunder::app {

Expecting in_folder(Interruption& interruption, std::optional<ResultFolder>& folder,
                    const std::filesystem::path& path, const std::string& nothing,
                    std::function<void()> besides) {
  const auto make = [&] {
    folder.emplace(path);
    const auto drop = [&folder, besides = std::move(besides)] {
      if (besides) besides();
      return folder->drop();
    };
    return Interruption::Duty{nothing + path.string(), drop, {}, {}};
  };
  return {interruption, make, [&folder] { folder->release(); }};
}

}  // namespace sunder::app
