// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <optional>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/in_folder.hpp"
#include "app/commands/mesh_scene.hpp"
#include "app/commands/waiting.hpp"
#include "app/input/mesh_import.hpp"
#include "app/input/scene_toml.hpp"
#include "app/output/text.hpp"
#ifdef SUNDER_VIEW
#include "app/commands/progress.hpp"
#include "app/output/result_folder.hpp"
#include "app/view/headless.hpp"
#include "app/view/window/open_window.hpp"
#endif
#include "sunder/backends.hpp"
#include "sunder/error.hpp"

namespace sunder::app {

#ifdef SUNDER_VIEW
namespace {

/// The scene and the inputs that are played: of --script or the scene's own.
struct Opened {
  OpenedScene scene;
  std::optional<Inputs> inputs;
};

Opened open_all(const ViewArguments& arguments) {
  Opened opened;
  if (arguments.script) opened.inputs = read_inputs(arguments.script->string());
  // A mesh alone has nothing that acts but a hand.
  const bool live = opened.inputs.has_value() || arguments.of_mesh;
  opened.scene = open_scene(arguments.scene, live);
  if (!opened.scene.recording.empty()) {
    throw InputError(InputFault::unknown_key,
                     arguments.scene.scene.string() +
                         ": recording is for sunder run and plan; leave the key out here");
  }
  if (opened.inputs && opened.scene.inputs) {
    throw UsageError("--script: the scene has inputs of its own, " + opened.scene.inputs->source +
                     "; play one or the other");
  }
  if (opened.inputs) {
    resolve(*opened.inputs, *opened.scene.problem);
  } else {
    opened.inputs = std::move(opened.scene.inputs);
  }
  return opened;
}

int count_of_frames(const ViewArguments& arguments, const Opened& opened) {
  if (arguments.frames) return *arguments.frames;
  if (!opened.inputs) return arguments.of_mesh ? 1 : opened.scene.problem->scene().steps;
  return std::max(opened.inputs->frames(), 1);
}

/// That of the simulation, where it is to be Vulkan's.
view::DeviceOptions device_options(const SolverOptions& solver) {
  view::DeviceOptions options;
  if (solver.backend == "vulkan") options.index = solver.device;
  return options;
}

void print_pictures(const Problem& problem, const Session& session, const HeadlessOutcome& outcome,
                    const view::Device& device, int frames, const std::filesystem::path& folder) {
  const int pictures = std::max(outcome.pictures, 1);
  const auto each = [&](const HeadlessOutcome::Stage& stage) {
    return rounded(1e3 * stage.seconds / pictures, 3) + " ms (" +
           rounded(1e3 * stage.processor_seconds / pictures, 3) + " of the processors)";
  };
  const BackendInfo info = session.simulation().backend().info();
  std::cout << problem.scene().title << "\n  "
            << counted(problem.tet_count(), "tetrahedron", "tetrahedra") << ", " << info.backend
            << " " << info.precision << ", route " << info.route << "; drawn by " << device.name()
            << "\n  " << counted(frames, "frame") << " after "
            << counted(session.simulation().steps_done(), "step") << ": "
            << "copied out in " << each(outcome.showing) << ", drawn in " << each(outcome.drawing)
            << ", written in " << each(outcome.writing) << " each\n  results in " << folder.string()
            << ":";
  const std::size_t shown = outcome.files.size();
  for (std::size_t i = 0; i < shown; ++i) {
    const bool many = outcome.files[i].starts_with("frame_") && shown > 8;
    if (many && i > 0 && i + 1 < shown && outcome.files[i + 1].starts_with("frame_")) {
      if (i == 1) std::cout << " ...";
      continue;
    }
    std::cout << " " << outcome.files[i];
  }
  std::cout << std::endl;
}

/// The backend of a problem, as often as it is asked for, on the device that draws where Vulkan is
/// to compute.
Simulation::MakeBackend make_backend(std::shared_ptr<const Problem> problem, view::Device& device,
                                     std::vector<std::string>& warnings) {
  return [problem = std::move(problem), &device, &warnings] {
    const Needs needs = needs_of(*problem);
    CreatedBackend created = problem->scene().solver.backend == "vulkan"
                                 ? create_backend_on(problem, needs, device.lend())
                                 : create_backend(problem, needs);
    for (std::string& w : created.warnings) {
      if (std::ranges::find(warnings, w) == warnings.end()) warnings.push_back(std::move(w));
    }
    return std::move(created.backend);
  };
}

std::filesystem::path out_of(const ViewArguments& arguments) {
  return arguments.out.value_or(std::filesystem::path("out") / arguments.scene.scene.stem());
}

void tell(const std::vector<std::string>& warnings) {
  for (const std::string& w : warnings) std::cerr << "sunder: warning: " << w << "\n";
}

int view_in_window(const ViewArguments& arguments) {
  if (arguments.script || arguments.frames) {
    throw UsageError("--script and --frames go with --headless: a window takes the mouse");
  }
  constexpr bool kLive = true;
  const OpenedScene scene = open_scene(arguments.scene, kLive);
  if (scene.inputs) {
    throw UsageError("the scene has inputs, " + scene.inputs->source +
                     ", which a window does not play; add --headless, or leave the key out");
  }
  std::vector<std::string> warnings = scene.warnings;
  WindowPlan plan;
  plan.device = device_options(scene.problem->scene().solver).index;
  constexpr PictureSize kWindow{1280, 800};
  plan.size = arguments.size.value_or(kWindow);
  plan.name = scene.problem->scene().title;
  plan.warnings = scene.warnings;
  plan.make_session = [&](view::Device& device) {
    const Waiting waiting("preparing " + counted(scene.problem->dof_count(), "unknown"),
                          !arguments.quiet);
    return std::make_unique<Session>(scene.problem, make_backend(scene.problem, device, warnings),
                                     true, plan.size);
  };
  plan.record = [&](const std::string& inputs) {
    const std::filesystem::path out = out_of(arguments);
    make_result_folder(out);
    write_file(out / "recording.inputs", inputs);
    write_file(out / "recording.toml",
               scene_text_for(arguments.scene.scene, overrides_of(arguments.scene), out,
                              "recording.inputs"));
    return "sunder run " + (out / "recording.toml").string() + " does it again";
  };
  open_window(plan);
  if (!arguments.quiet) tell(warnings);
  return 0;
}

int view_headless(const ViewArguments& arguments, Interruption& interruption) {
  const Opened opened = open_all(arguments);
  const std::shared_ptr<const Problem>& problem = opened.scene.problem;
  std::optional<ResultFolder> folder;
  const std::filesystem::path out = out_of(arguments);
  const Expecting preparing =
      in_folder(interruption, folder, out, "no picture was kept, and nothing written to ");
  std::vector<std::string> warnings = opened.scene.warnings;
  if (folder->warning()) warnings.push_back(*folder->warning());
  view::Device device(device_options(problem->scene().solver));
  const PictureSize size = arguments.size.value_or(PictureSize{});
  std::optional<Session> session;
  {
    const Waiting waiting("preparing " + counted(problem->dof_count(), "unknown"),
                          !arguments.quiet);
    session.emplace(problem, make_backend(problem, device, warnings), opened.inputs.has_value(),
                    size);
  }
  Painter painter(device, *problem, size);
  HeadlessPlan plan;
  plan.inputs = opened.inputs ? &*opened.inputs : nullptr;
  plan.frames = count_of_frames(arguments, opened);
  plan.recording = scene_text_for(arguments.scene.scene, overrides_of(arguments.scene), out,
                                  opened.inputs ? "recording.inputs" : "");
  Progress progress(plan.frames, !arguments.quiet, "destroyed", "frame");
  plan.progress = [&](int frame) {
    progress.update(frame, static_cast<int>(session->simulation().destroyed().size()));
  };
  folder->clear();
  const HeadlessOutcome outcome = play(*session, painter, *folder, plan);
  progress.finish();
  if (outcome.failure) {
    throw NumericalError(*outcome.failure + " (in step " +
                         std::to_string(session->simulation().steps_done() + 1) +
                         "): pictures so far are in " + out.string());
  }
  for (const std::string& w : session->simulation().warnings()) warnings.push_back(w);
  if (outcome.inputs_left) {
    warnings.push_back(opened.inputs->source + " has more frames than " +
                       std::to_string(plan.frames) + ": what comes after them was left out");
  }
  if (!arguments.quiet) tell(warnings);
  print_pictures(*problem, *session, outcome, device, plan.frames, out);
  return 0;
}

}  // namespace

int view_scene(const ViewArguments& given, Interruption& interruption) {
  ViewArguments arguments = given;
  std::optional<MeshScene> of_mesh;
  if (is_mesh_file(given.scene.scene)) {
    of_mesh.emplace(given.scene.scene);
    arguments.scene.scene = of_mesh->file();
    arguments.of_mesh = true;
  }
  if (arguments.headless) return view_headless(arguments, interruption);
  const Expecting open(interruption, Interruption::Duty{"the window was closed", {}, {}, {}});
  return view_in_window(arguments);
}
#else
int view_scene(const ViewArguments&, Interruption&) {
  throw DeviceError("this build draws nothing: it was made without " SUNDER_NO_VIEW
                    "; `sunder run` writes figures");
}
#endif

}  // namespace sunder::app
