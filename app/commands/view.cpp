// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <optional>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/in_folder.hpp"
#include "app/commands/waiting.hpp"
#include "app/input/mesh_import.hpp"
#include "app/output/text.hpp"
#ifdef SUNDER_VIEW
#include "app/commands/progress.hpp"
#include "app/commands/view_bodies.hpp"
#include "app/output/result_folder.hpp"
#include "app/view/headless.hpp"
#include "app/view/window/open_window.hpp"
#endif
#include "sunder/error.hpp"

namespace sunder::app {

#ifdef SUNDER_VIEW
namespace {

/// The inputs that are played: of --script or the scene's own.
std::optional<Inputs> inputs_of(std::optional<Inputs> script, OpenedScene& opened) {
  if (script && opened.inputs) {
    throw UsageError("--script: the scene has inputs of its own, " + opened.inputs->source +
                     "; play one or the other");
  }
  if (!script) return std::move(opened.inputs);
  resolve(*script, *opened.problem);
  return script;
}

int count_of_frames(const ViewArguments& arguments, const std::optional<Inputs>& inputs,
                    const Scene& scene) {
  if (arguments.frames) return *arguments.frames;
  if (!inputs) return is_mesh_file(arguments.scene.scene) ? 1 : scene.steps;
  return std::max(inputs->frames(), 1);
}

/// That of the simulation, where it is to be Vulkan's.
view::DeviceOptions device_options(const SolverOptions& solver) {
  view::DeviceOptions options;
  options.probe = view::probe_from_environment();
  if (solver.backend == "vulkan") options.index = solver.device;
  return options;
}

/// One after the other: computed, copied out and drawn.
double pictures_a_second(const HeadlessOutcome& outcome) {
  const double seconds =
      outcome.stepping.seconds + outcome.showing.seconds + outcome.drawing.seconds;
  return seconds > 0 ? outcome.pictures / seconds : 0;
}

void print_pictures(const Session& session, const HeadlessOutcome& outcome,
                    const view::Device& device, int frames, const std::filesystem::path& folder) {
  const Problem& problem = session.problem();
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
            << "computed in " << each(outcome.stepping) << ", copied out in "
            << each(outcome.showing) << ", drawn in " << each(outcome.drawing) << ", written in "
            << each(outcome.writing) << " each; " << rounded(pictures_a_second(outcome), 3)
            << " a second without the writing\n  results in " << folder.string() << ":";
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
  std::vector<std::string> warnings;
  const ViewBodies bodies(arguments.scene, warnings, true);
  constexpr bool kLive = true;
  const OpenedScene scene = bodies.open(bodies.first(), kLive);
  if (scene.inputs) {
    throw UsageError("the scene has inputs, " + scene.inputs->source +
                     ", which a window does not play; add --headless, or leave the key out");
  }
  warnings = scene.warnings;
  WindowPlan plan;
  const view::DeviceOptions asked = device_options(scene.problem->scene().solver);
  plan.device = asked.index;
  plan.probe = asked.probe;
  constexpr PictureSize kWindow{1280, 800};
  plan.size = arguments.size.value_or(kWindow);
  plan.name = scene.problem->scene().title;
  plan.warnings = scene.warnings;
  plan.make_session = [&](view::Devices& devices) {
    const Waiting waiting("preparing " + counted(scene.problem->dof_count(), "unknown"),
                          !arguments.quiet);
    const BodyPlan body = bodies.body(scene.problem, devices);
    auto session = std::make_unique<Session>(body.problem, body.make, true, plan.size, body.points);
    session->can_change(bodies.first(), bodies.plan(devices));
    return session;
  };
  plan.record = [&](const std::string& inputs, const Origin& origin) {
    const std::filesystem::path out = out_of(arguments);
    make_result_folder(out);
    write_file(out / "recording.inputs", inputs);
    write_file(out / "recording.toml", bodies.text_for(origin, out, "recording.inputs"));
    return "sunder run " + (out / "recording.toml").string() + " does it again";
  };
  open_window(plan);
  if (!arguments.quiet) tell(warnings);
  return 0;
}

int view_headless(const ViewArguments& arguments, Interruption& interruption) {
  std::optional<Inputs> script;
  if (arguments.script) script = read_inputs(arguments.script->string());
  std::vector<std::string> warnings;
  const bool change = script && std::any_of(script->list.begin(), script->list.end(), changes_body);
  const ViewBodies bodies(arguments.scene, warnings, change);
  // A mesh alone has nothing that acts but a hand.
  const bool live = script || is_mesh_file(arguments.scene.scene);
  OpenedScene opened = bodies.open(bodies.first(), live);
  const std::optional<Inputs> inputs = inputs_of(std::move(script), opened);
  const std::shared_ptr<const Problem>& problem = opened.problem;
  std::optional<ResultFolder> folder;
  const std::filesystem::path out = out_of(arguments);
  const Expecting preparing =
      in_folder(interruption, folder, out, "no picture was kept, and nothing written to ");
  warnings = opened.warnings;
  if (folder->warning()) warnings.push_back(*folder->warning());
  view::Devices devices(device_options(problem->scene().solver));
  const PictureSize size = arguments.size.value_or(PictureSize{});
  std::optional<Session> session;
  {
    const Waiting waiting("preparing " + counted(problem->dof_count(), "unknown"),
                          !arguments.quiet);
    // A simulation on the device that draws does again what it did should that be lost.
    const bool goes_back = inputs || problem->scene().solver.backend == "vulkan";
    const BodyPlan body = bodies.body(problem, devices);
    session.emplace(body.problem, body.make, goes_back, size, body.points);
    session->can_change(bodies.first(), bodies.plan(devices));
  }
  auto painter = std::make_unique<Painter>(devices.now(), size);
  HeadlessPlan plan;
  plan.inputs = inputs ? &*inputs : nullptr;
  plan.frames = count_of_frames(arguments, inputs, problem->scene());
  plan.recording = [&](const Origin& origin) {
    return bodies.text_for(origin, out, inputs ? "recording.inputs" : "");
  };
  Progress progress(plan.frames, !arguments.quiet, "destroyed", "frame");
  plan.progress = [&](int frame) {
    progress.update(frame, static_cast<int>(session->simulation().destroyed().size()));
  };
  plan.renew = [&](const std::string& why) -> Painter& {
    warnings.push_back(why + "; it went on with a new device, and nothing is missing");
    painter.reset();
    devices.renew();
    session->renew();
    painter = std::make_unique<Painter>(devices.now(), size);
    return *painter;
  };
  folder->clear();
  const HeadlessOutcome outcome = play(*session, *painter, *folder, plan);
  progress.finish();
  if (outcome.lost) {
    throw DeviceError("the device was lost under the drawing, and there is none in its place: " +
                      *outcome.lost + "; what was done is in " + (out / "recording.toml").string() +
                      ", which sunder run does again");
  }
  if (outcome.failure) {
    throw NumericalError(*outcome.failure + " (in step " +
                         std::to_string(session->simulation().steps_done() + 1) +
                         "): pictures so far are in " + out.string());
  }
  for (const std::string& w : session->simulation().warnings()) warnings.push_back(w);
  if (outcome.inputs_left) {
    warnings.push_back(inputs->source + " has more frames than " + std::to_string(plan.frames) +
                       ": what comes after them was left out");
  }
  if (!arguments.quiet) tell(warnings);
  print_pictures(*session, outcome, devices.now(), plan.frames, out);
  return 0;
}

}  // namespace

int view_scene(const ViewArguments& arguments, Interruption& interruption) {
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
