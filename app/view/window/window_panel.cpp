// SPDX-License-Identifier: Apache-2.0
// What stands beside the picture.
#include <cmath>

#include "app/output/text.hpp"
#include "app/view/window/window.hpp"

namespace sunder::app {

void Window::panel() {
  ImGui::SetNextWindowPos(
      {static_cast<float>(size_.width) - 8, static_cast<float>(size_.height) - 8}, ImGuiCond_Always,
      {1, 1});
  ImGui::SetNextWindowBgAlpha(0.75F);
  ImGui::Begin("sunder", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  buttons();
  hands();
  numbers();
  colours();
  ImGui::TextDisabled(
      "left: tissue, an instrument, or turn; right: cut; middle: shift; wheel: zoom");
  ImGui::TextDisabled("in hand: P pins it there, shift turns a patch; M: law, crack, material");
  for (const std::string& line : now_.ruptures) ImGui::TextUnformatted(line.c_str());
  if (now_.error) told(*now_.error);
  preparing();
  if (!now_.said.empty()) ImGui::TextWrapped("%s", now_.said.c_str());
  {
    const std::lock_guard lock(said_lock_);
    if (!said_.empty()) ImGui::TextWrapped("%s", said_.c_str());
  }
  for (const std::string& warning : plan_.warnings) ImGui::TextWrapped("%s", warning.c_str());
  ImGui::End();
}

void Window::told(const std::string& error) const {
  ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.6F, 0.4F, 1));
  ImGui::TextWrapped("paused: %s", error.c_str());
  ImGui::PopStyleColor();
}

void Window::buttons() {
  if (ImGui::Button(live_.paused() ? "go (space)" : "pause (space)")) {
    live_.pause(!live_.paused());
  }
  ImGui::SameLine();
  if (ImGui::Button("step (S)")) single_step();
  ImGui::SameLine();
  if (ImGui::Button("reset (R)")) reset();
  if (ImGui::Button("undo (Z)")) live_.post(input::Undo{});
  ImGui::SameLine();
  if (ImGui::Button("redo (Y)")) live_.post(input::Redo{});
  ImGui::SameLine();
  if (ImGui::Button("record (E)")) record();
  ImGui::Text("%d to undo, %d to redo%s", now_.undos, now_.redos,
              now_.done ? "; all steps done (--steps N)" : "");
}

/// What is in the hand, by its own thread.
void Window::hands() {
  ImGui::SetNextItemWidth(140);
  ImGui::SliderFloat("patch [mm] (+ -)", &patch_, 0, largest_patch_,
                     patch_ > 0 ? "%.2f" : "a node");
  const HapticLoop::Now hand = haptics_.now();
  if (!hand.holds) {
    if (!now_.grips.empty()) {
      ImGui::Text("%d pinned: take one to let it go", static_cast<int>(now_.grips.size()));
    }
    return;
  }
  const char* pinned = pinned_ ? ", pinned" : "";
  if (hand.felt.state != FeltState::live) {
    ImGui::Text("in hand%s: no force yet", pinned);
    return;
  }
  ImGui::Text("in hand%s: %.3g N at 1 kHz, by solution %llu, %.0f ms old", pinned,
              hand.force.norm(), static_cast<unsigned long long>(hand.felt.solution),
              hand.felt.age_ms);
}

void Window::numbers() const {
  const auto& report = now_.shown->report;
  if (!report) {
    ImGui::Text("drawn in %.1f ms", drawing_ms_);
    return;
  }
  const StageTimes& t = report->times;
  ImGui::Text("step %.2f ms: load %.2f  solve %.2f  stress %.2f", t.total, t.load, t.solve,
              t.stress);
  ImGui::Text("  decide %.2f  update %.2f;  drawn in %.1f ms", t.decide, t.update, drawing_ms_);
  ImGui::Text("error %.1e  back-solves %d", report->error, report->back_solves);
  if (!report->deformation) return;
  const bool small = !problem().finite();
  ImGui::Text("strain %.1f %%%s  rotation %.1f deg%s", 100 * report->deformation->strain,
              small ? " (law linear: to 10)" : "", report->deformation->rotation_deg,
              small ? " (to 10)" : "");
}

void Window::colours() {
  int field = static_cast<int>(look_.colour->field);
  std::string names;
  for (const std::string& name : field_names()) names += name + '\0';
  ImGui::SetNextItemWidth(140);
  if (ImGui::Combo("colour (1-4)", &field, names.c_str())) colour_by(static_cast<Field>(field));
  ImGui::SameLine();
  bool fixed = look_.colour->maximum.has_value();
  if (ImGui::Checkbox("fixed scale", &fixed)) {
    look_.colour->maximum = fixed ? std::optional(1.0) : std::nullopt;
  }
  if (fixed) {
    ImGui::SameLine();
    double end = *look_.colour->maximum;
    ImGui::SetNextItemWidth(90);
    if (ImGui::InputDouble("end", &end, 0, 0, "%.3g") && end > 0) look_.colour->maximum = end;
  }
  ImGui::Checkbox("wireframe (W)", &look_.wireframe);
  ImGui::SameLine();
  ImGui::Checkbox("arrows", &look_.arrows);
  ImGui::SameLine();
  ImGui::Checkbox("tips", &look_.tips);
  ImGui::SameLine();
  ImGui::Checkbox("fibres", &look_.fibres);
  ImGui::SameLine();
  bool clipped = look_.clip.normal.has_value();
  if (ImGui::Checkbox("clip (C)", &clipped)) toggle_clip();
  if (look_.clip.normal) {
    auto offset = static_cast<float>(look_.clip.offset);
    const Camera camera(look_.camera, look_.at, shown_points_, size_);
    const auto middle = static_cast<float>(look_.clip.normal->dot(camera.middle()));
    const auto half = static_cast<float>(camera.depth() / 12);
    ImGui::SliderFloat("clip at [mm]", &offset, middle - half, middle + half);
    look_.clip.offset = offset;
  }
}

}  // namespace sunder::app
