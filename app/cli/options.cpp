// SPDX-License-Identifier: Apache-2.0
#include "app/cli/options.hpp"

#include <algorithm>
#include <thread>
#include <tuple>
#include <utility>

#include "app/cli/values.hpp"
#include "app/commands/commands.hpp"
#include "app/system/utf8_path.hpp"
#include "sunder/backends.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

void add_scene_options(CLI::App& command, Options& o) {
  command.add_option("SCENE.toml", o.scene, "Scene file")->required()->type_name("");
  command.add_option("--backend", o.backend, "auto, cpu or vulkan")->type_name("B");
  command.add_option("--device", o.device, "Device of the backend, see `sunder devices`")
      ->type_name("N");
  command.add_option("--route", o.route, "auto, inverse, condensed, factor or cg")->type_name("R");
  command.add_option("--update", o.update, "auto, eager or deferred")->type_name("U");
  command.add_option("--precision", o.precision, "auto, fp32 or fp64")->type_name("P");
  command.add_option("--steps", o.steps, "Number of steps, instead of the scene's")->type_name("N");
  command
      .add_option("--set", o.set,
                  "Override or add a key of the scene, arrays by index: "
                  "instrument.0.force=[0,-50,0]; may be given several times")
      ->type_name("KEY.PATH=VALUE")
      ->type_size(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// Output options; `plan` takes and ignores them, so that a command line can be tried out.
void add_output_options(CLI::App& command, Options& o) {
  command.add_option("--out", o.out, "Folder for the results (default out/<scene name>)")
      ->type_name("DIR");
  command.add_flag("--series", o.series, "Write a VTU file per step and series.pvd");
  command
      .add_option("--snapshots", o.snapshots,
                  "Figure and VTU when so many elements are destroyed: 5,10,20,40")
      ->type_name("N,N,...");
  command.add_flag("--quiet", o.quiet, "No progress and no warnings on stderr");
}

void add_mesh_options(CLI::App& mesh, Options& o) {
  mesh.require_subcommand(1);
  CLI::App& board =
      *mesh.add_subcommand("board", "The paper's board, 500 to 1,000,000 tetrahedra and more");
  board.add_option("--nx", o.nx, "Cells along x")->type_name("N");
  board.add_option("--ny", o.ny, "Cells along y")->type_name("N");
  board.add_option("--nz", o.nz, "Cells through the thickness")->type_name("N");
  board.add_option("--tets", o.tets, "About this many tetrahedra, instead of cells")
      ->type_name("N");
  board.add_option("--thickness", o.thickness, "Thickness of the board [mm]")->type_name("MM");
  board.add_flag("--unstructured", o.unstructured, "Delaunay mesh instead of a grid");
  board.add_flag("--ascii", o.ascii, "Text instead of binary .msh");
  board.add_option("-o,--output", o.mesh_file, "Mesh file to write: .msh, .vtk, .mesh, ...")
      ->required()
      ->type_name("FILE");
}

void add_reproduce_options(CLI::App& command, Options& o) {
  command.add_option("--out", o.out, "Folder for the results (default out/reproduce)")
      ->type_name("DIR");
  command.add_option("--backend", o.backend, "auto, cpu (default) or vulkan")->type_name("B");
  command.add_flag("--quick", o.quick, "Fewer sizes, lengths and positions");
  command.add_flag("--quiet", o.quiet, "No progress on stderr");
}

void add_sweep_options(CLI::App& command, Options& o) {
  command
      .add_option("--vary", o.vary,
                  "A key of the scene with its values, KEY.PATH=A,B,C or KEY.PATH=LOW:HIGH:COUNT; "
                  "several multiply, the first the slowest")
      ->type_name("KEY.PATH=VALUES")
      ->type_size(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--out", o.out, "Folder for the table (needed)")->type_name("DIR");
  command.add_option("--jobs", o.jobs, "Runs at a time (default: one a processor)")->type_name("N");
  command.add_option("--part", o.part, "Part i of n: every n-th run, into DIR/part-i-of-n")
      ->type_name("I/N");
  command.add_flag("--merge", o.merge, "Make the one table of the parts that are there");
  command.add_flag("--resume", o.resume, "Go on with the sweep that is in the folder");
  command.add_flag("--quiet", o.quiet, "No progress and no warnings on stderr");
}

void add_view_options(CLI::App& command, Options& o) {
  command.add_flag("--headless", o.headless, "No window: pictures, a film strip, the recording");
  command.add_option("--out", o.out, "Folder for the pictures (default out/<scene name>)")
      ->type_name("DIR");
  command
      .add_option("--frames", o.frames,
                  "Number of pictures (default: the script's, or the scene's steps)")
      ->type_name("N");
  command.add_option("--script", o.script, "Inputs to play, one a line (docs/view.md)")
      ->type_name("INPUTS");
  command.add_option("--size", o.size, "Of a picture (default 960x720)")->type_name("WxH");
  command.add_flag("--quiet", o.quiet, "No progress and no warnings on stderr");
}

SceneArguments scene_arguments(const Options& o) {
  SceneArguments arguments;
  arguments.scene = system::utf8_path(o.scene);
  const auto word = [](const std::string& option, const Options::Text& value,
                       const std::vector<std::string>& allowed) {
    if (value) check_word(option, *value, allowed);
    return value;
  };
  arguments.backend = word("--backend", o.backend, {"auto", "cpu", "vulkan"});
  arguments.route = word("--route", o.route, {"auto", "inverse", "condensed", "factor", "cg"});
  arguments.update = word("--update", o.update, {"auto", "eager", "deferred"});
  arguments.precision = word("--precision", o.precision, {"auto", "fp32", "fp64"});
  if (o.device) arguments.device = whole_number("--device", *o.device, 0);
  if (o.steps) arguments.steps = whole_number("--steps", *o.steps, 1);
  for (const std::string& text : o.set)
    if (text.find('=') == std::string::npos || text.front() == '=')
      throw UsageError("--set is \"" + shortened(text, 120) +
                       "\"; allowed is KEY.PATH=VALUE such as instrument.0.force=[0,-50,0]");
  arguments.set = o.set;
  return arguments;
}

RunArguments run_arguments(const Options& o) {
  RunArguments arguments;
  arguments.scene = scene_arguments(o);
  if (o.out && o.out->empty()) throw UsageError("--out is \"\"; allowed is the name of a folder");
  if (o.out) arguments.out = system::utf8_path(*o.out);
  if (o.snapshots) arguments.snapshots = number_list("--snapshots", *o.snapshots);
  arguments.series = o.series;
  arguments.quiet = o.quiet;
  return arguments;
}

ReproduceArguments reproduce_arguments(const Options& o) {
  ReproduceArguments arguments;
  if (o.out && o.out->empty()) throw UsageError("--out is \"\"; allowed is the name of a folder");
  if (o.out) arguments.out = system::utf8_path(*o.out);
  if (o.backend) check_word("--backend", *o.backend, {"auto", "cpu", "vulkan"});
  arguments.backend = o.backend.value_or(arguments.backend);
  arguments.quick = o.quick;
  arguments.quiet = o.quiet;
  return arguments;
}

/// "2/8".
std::pair<int, int> part_of(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto refuse = [&] {
    throw UsageError("--part is " + in_quotes(text) +
                     "; allowed is I/N with I from 1 to N such as 2/8");
  };
  if (slash == std::string::npos) refuse();
  int i = 0, n = 0;
  try {
    i = whole_number("--part", text.substr(0, slash), 1);
    n = whole_number("--part", text.substr(slash + 1), 1);
  } catch (const UsageError&) {
    refuse();
  }
  if (i > n) refuse();
  return {i, n};
}

SweepArguments sweep_arguments(const Options& o) {
  SweepArguments arguments;
  arguments.scene = scene_arguments(o);
  arguments.vary = o.vary;
  if (!o.out || o.out->empty()) throw UsageError("sunder sweep needs --out, a folder of its own");
  arguments.out = system::utf8_path(*o.out);
  constexpr int kMostJobs = 1024;
  arguments.jobs = o.jobs ? whole_number("--jobs", *o.jobs, 1)
                          : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (arguments.jobs > kMostJobs) {
    throw UsageError("--jobs is " + in_quotes(*o.jobs) + "; allowed are at most " +
                     std::to_string(kMostJobs) + ", and a processor each is enough");
  }
  if (o.part) std::tie(arguments.part, arguments.parts) = part_of(*o.part);
  if (o.merge && (o.part || o.resume)) {
    throw UsageError("--merge takes neither --part nor --resume");
  }
  arguments.merge = o.merge;
  arguments.resume = o.resume;
  arguments.quiet = o.quiet;
  return arguments;
}

/// "960x720".
PictureSize picture_size(const std::string& text) {
  constexpr int kLeast = 64, kMost = 8192;
  const std::size_t cross = text.find('x');
  const auto refuse = [&] {
    throw UsageError("--size is " + in_quotes(text) + "; allowed is WIDTHxHEIGHT in pixels, " +
                     std::to_string(kLeast) + " to " + std::to_string(kMost) +
                     " each, such as 960x720");
  };
  if (cross == std::string::npos) refuse();
  PictureSize size;
  try {
    size.width = whole_number("--size", text.substr(0, cross), kLeast);
    size.height = whole_number("--size", text.substr(cross + 1), kLeast);
  } catch (const UsageError&) {
    refuse();
  }
  if (std::max(size.width, size.height) > kMost) refuse();
  return size;
}

ViewArguments view_arguments(const Options& o) {
  ViewArguments arguments;
  arguments.scene = scene_arguments(o);
  for (const auto& [option, value] : {std::pair("--out", &o.out), std::pair("--script", &o.script)})
    if (*value && (*value)->empty())
      throw UsageError(std::string(option) + " is \"\"; allowed is a name");
  if (o.out) arguments.out = system::utf8_path(*o.out);
  if (o.script) arguments.script = system::utf8_path(*o.script);
  if (o.frames) arguments.frames = whole_number("--frames", *o.frames, 1);
  if (o.size) arguments.size = picture_size(*o.size);
  arguments.headless = o.headless;
  arguments.quiet = o.quiet;
  return arguments;
}

BoardArguments board_arguments(const Options& o) {
  BoardArguments arguments;
  BoardOptions& board = arguments.options;
  if (o.nx) board.nx = whole_number("--nx", *o.nx, 1);
  if (o.ny) board.ny = whole_number("--ny", *o.ny, 1);
  if (o.nz) board.nz = whole_number("--nz", *o.nz, 1);
  if (o.tets) board.tets = whole_number("--tets", *o.tets, 1);
  if (o.thickness) board.thickness = positive_number("--thickness", *o.thickness);
  board.unstructured = o.unstructured;
  board.ascii = o.ascii;
  arguments.file = system::utf8_path(o.mesh_file);
  return arguments;
}

}  // namespace

void add_commands(CLI::App& app, Options& options) {
  CLI::App& run_command = *app.add_subcommand("run", "Simulate a scene and write its results");
  add_scene_options(run_command, options);
  add_output_options(run_command, options);
  CLI::App& plan_command = *app.add_subcommand("plan", "What a scene needs and what is left out");
  add_scene_options(plan_command, options);
  add_output_options(plan_command, options);
  plan_command.add_flag("--measure", options.measure,
                        "Run the first steps and print the time of every stage and device pass");
  CLI::App& view_command =
      *app.add_subcommand("view", "Look at a body while it is pulled, cut and torn");
  add_scene_options(view_command, options);
  add_view_options(view_command, options);
  CLI::App& sweep_command =
      *app.add_subcommand("sweep", "Many runs of a scene with other values, in one table");
  add_scene_options(sweep_command, options);
  add_sweep_options(sweep_command, options);
  add_reproduce_options(
      *app.add_subcommand("reproduce", "The paper's experiments with figures and verdicts"),
      options);
  add_mesh_options(*app.add_subcommand("mesh", "Make meshes"), options);
  app.add_subcommand("devices", "Devices and backends, and what would be chosen")
      ->add_flag("--measure", options.measure,
                 "Measure anew what each Vulkan device does in a second; plans predict by it");
  app.add_subcommand("materials",
                     "Tissues that a scene can name, with where their numbers are from");
  app.add_subcommand("help", "Help for a command")
      ->add_option("command", options.help_path, "Command")
      ->type_name("COMMAND");
}

int carry_out(const CLI::App& app, const Options& options, Interruption& interruption) {
  if (app.got_subcommand("run")) return run(run_arguments(options), interruption);
  if (app.got_subcommand("plan")) return plan(run_arguments(options).scene, options.measure);
  if (app.got_subcommand("view")) return view_scene(view_arguments(options), interruption);
  if (app.got_subcommand("sweep")) return sweep_scene(sweep_arguments(options), interruption);
  if (app.got_subcommand("reproduce"))
    return reproduce_paper(reproduce_arguments(options), interruption);
  if (app.got_subcommand("mesh")) return mesh_board(board_arguments(options), interruption);
  if (app.got_subcommand("materials")) return list_materials();
  return list_devices(options.measure);
}

}  // namespace sunder::app
