// SPDX-License-Identifier: Apache-2.0
// The scenes that come with the program: each is read, checked, and has what its kind needs.
#include <set>

#include "app/input/input_support.hpp"
#include "app/input/scene_toml.hpp"

namespace sunder::test {
namespace {

std::set<std::filesystem::path> scene_files() {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SUNDER_SCENES))
    if (entry.path().extension() == ".toml") files.insert(entry.path());
  return files;
}

TEST(SceneFiles, AllAreThere) {
  std::set<std::string> names;
  for (const auto& file : scene_files()) names.insert(file.stem());
  for (const char* name : {"board-grip-b",
                           "board-pull-a",
                           "board-pull-b",
                           "board-pull-two-points-a",
                           "board-pull-two-points-b",
                           "notch-a",
                           "notch-b",
                           "pressure-near",
                           "pressure-far",
                           "pressure-upper",
                           "pressure-balanced",
                           "pressure-under",
                           "two-instruments",
                           "cantilever",
                           "stiff-contrast",
                           "nearly-incompressible",
                           "scripted-cut",
                           "board-grip",
                           "liver",
                           "artery",
                           "peel",
                           "brain-notch",
                           "skin",
                           "skin-wounds",
                           "board",
                           "board-split",
                           "board-falls",
                           "sheet",
                           "strip-90",
                           "strip-180",
                           "artery-motion",
                           "membrane"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST(SceneFiles, AreRightWithoutWarning) {
  for (const auto& file : scene_files()) {
    SCOPED_TRACE(file);
    std::vector<std::string> warnings;
    std::shared_ptr<const Problem> problem;
    ASSERT_NO_THROW(problem = app::read_problem(file, {}, &warnings));
    EXPECT_TRUE(warnings.empty()) << warnings.front();
    EXPECT_FALSE(problem->scene().title.empty());
    EXPECT_TRUE(!problem->scene().instruments.empty() || !problem->scene().gravity.isZero());
    for (Index e = 0; e < problem->tet_count(); ++e) {
      const std::string& name =
          problem->mesh().volumes[static_cast<std::size_t>(problem->mesh().volume_of[e])].name;
      if (name.ends_with("frame") && file.stem() != "sheet") {  // which is of one tissue
        ASSERT_FALSE(problem->breakable(e)) << name;
      }
    }
  }
}

}  // namespace
}  // namespace sunder::test
