// SPDX-License-Identifier: Apache-2.0
// The commands of the program, one function each. They print results on stdout, progress and
// warnings on stderr, return the exit code and throw sunder::Error. Those that write files say what
// a signal is to do about them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/interruption.hpp"
#include "app/commands/scene_arguments.hpp"
#include "app/mesh_board/board.hpp"

namespace sunder::app {

struct RunArguments {
  SceneArguments scene;
  std::optional<std::filesystem::path> out;  ///< default: out/<scene name>
  std::vector<int> snapshots;                ///< numbers of destroyed elements
  bool series = false;
  bool quiet = false;
};

struct BoardArguments {
  BoardOptions options;
  std::filesystem::path file;
};

struct ReproduceArguments {
  std::filesystem::path out = "out/reproduce";
  std::string backend = "cpu";  ///< the verdicts do not depend on the machine's devices
  bool quick = false;
  bool quiet = false;
};

struct ViewArguments {
  SceneArguments scene;
  std::optional<std::filesystem::path> out;     ///< default: out/<scene name>
  std::optional<std::filesystem::path> script;  ///< inputs
  std::optional<int> frames;                    ///< default: the script's, or the scene's steps
  std::optional<PictureSize> size;  ///< default: that of PictureSize; a window's is larger
  bool headless = false;
  bool quiet = false;
};

struct SweepArguments {
  SceneArguments scene;
  std::vector<std::string> vary;  ///< "key.path=a,b,c" or "key.path=lo:hi:n"
  std::filesystem::path out;
  int jobs = 1;
  int part = 1, parts = 1;
  bool merge = false, resume = false, quiet = false;
};

int run(const RunArguments& arguments, Interruption& interruption);
/// `measure`: run the first steps and print the time of each stage and pass.
int plan(const SceneArguments& arguments, bool measure);
/// `measure`: what they do in a second, anew.
int list_devices(bool measure);
/// The tissues that a material's `preset` may name, each number with its source.
int list_materials();
int reproduce_paper(const ReproduceArguments& arguments, Interruption& interruption);
int view_scene(const ViewArguments& arguments, Interruption& interruption);
int sweep_scene(const SweepArguments& arguments, Interruption& interruption);
int mesh_board(const BoardArguments& arguments, Interruption& interruption);

}  // namespace sunder::app
