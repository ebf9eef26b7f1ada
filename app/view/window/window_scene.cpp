// SPDX-License-Identifier: Apache-2.0
// What changes the body itself: law, crack way and material constants, and files that are dropped.
#include <chrono>

#include "app/output/text.hpp"
#include "app/view/window/window.hpp"
#include "sunder/scene_keys.hpp"

namespace sunder::app {
namespace {

constexpr float kField = 110;  // width of a number [px]

/// True: another word of the key was taken.
template <class Word>
void words(const char* label, const char* table, const char* key, Word& value) {
  std::string all;
  for (const std::string& word : key_words(table, key)) all += word + '\0';
  int at = static_cast<int>(value);
  ImGui::SetNextItemWidth(1.5F * kField);
  if (ImGui::Combo(label, &at, all.c_str())) value = static_cast<Word>(at);
}

void constant(const char* label, double& value) {
  ImGui::SetNextItemWidth(kField);
  ImGui::InputDouble(label, &value, 0, 0, "%.6g");
}

/// 0: there is none.
void constant(const char* label, std::optional<double>& value) {
  double number = value.value_or(0);
  constant(label, number);
  value = number == 0 ? std::nullopt : std::optional(number);
}

}  // namespace

/// The frame is of a body that this window has not seen yet.
void Window::meet_body() {
  if (now_.body == body_) return;
  body_ = now_.body;
  shown_points_ = shown_points(problem());
  edited_.reset();
  haptics_.feel(now_.forces);
  if (now_.origin.file != file_) {
    file_ = now_.origin.file;
    look_ = Look{};
    look_.camera = standard_camera(problem().mesh());
    haptics_.let_go();
    grip_ = kNone;
    asked_ = false;
    turns_.clear();
    if (holds_ != Holds::blade) holds_ = Holds::nothing;
    glfwSetWindowTitle(window_.get(), problem().scene().title.c_str());
    take_measure();
  }
  if (!computes(look_.colour ? look_.colour->field : Field::stress) || !look_.colour) {
    look_.colour = input::Colour{standard_field(problem()), {}};
  }
  if (holds_ == Holds::instrument && held_ >= now_.values.size()) holds_ = Holds::nothing;
  for (const LiveSession::HeldNodes& grip : now_.grips) {
    if (grip.grip != grip_) continue;  // it has gone along
    aim_ = grip.place;
    haptics_.hold({grip_, aim_, turn_}, grip.of_body);
  }
}

/// Patches are as large as the body allows.
void Window::take_measure() {
  Vec3 low = problem().mesh().nodes.front(), high = low;
  for (const Vec3& x : problem().mesh().nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  largest_patch_ = static_cast<float>((high - low).maxCoeff() / 5);
  patch_ = std::min(patch_, largest_patch_);
}

/// One file in place of what is there; what is wrong with it is told, and that stays.
void Window::take_files() {
  if (events_.files.empty()) return;
  if (events_.files.size() == 1) {
    live_.post(input::Open{events_.files.front()});
  } else {
    say(std::to_string(events_.files.size()) +
        " files were dropped; a window shows one scene or mesh: drop one");
  }
  events_.files.clear();
}

void Window::preparing() const {
  if (now_.preparing.empty()) return;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - now_.since;
  ImGui::TextWrapped("preparing %s: %s s; what is shown stays until then", now_.preparing.c_str(),
                     rounded(passed.count(), 2).c_str());
}

void Window::scene_panel() {
  if (!edits_) return;
  ImGui::SetNextWindowPos({8, 100}, ImGuiCond_Once);
  ImGui::SetNextWindowBgAlpha(0.75F);
  ImGui::Begin("law, crack, material", &edits_, ImGuiWindowFlags_AlwaysAutoResize);
  scene_fields();
  ImGui::End();
}

void Window::scene_fields() {
  const SceneEdit is = edit_of(problem());
  if (!edited_) edited_ = is;
  for (SceneEdit::OfVolume& of : edited_->volumes) {
    ImGui::PushID(of.volume.c_str());
    Material& m = of.material;
    ImGui::TextUnformatted(of.volume.c_str());
    words("law", "material", "law", m.law);
    constant("E [MPa]", m.young);
    ImGui::SameLine();
    constant("nu", m.poisson);
    constant("yield [MPa]", m.yield);
    ImGui::SameLine();
    m.energy ? constant("G_c [N/mm]", m.energy) : constant("K_c", m.toughness);
    ImGui::PopID();
  }
  words("model", "fracture", "model", edited_->model);
  words("crack", "fracture", "crack", edited_->crack);
  words("K by", "fracture", "sif", edited_->sif);
  const std::vector<std::string> changes = changes_of(is, *edited_);
  if (ImGui::Button("apply (A)")) apply();
  ImGui::SameLine();
  if (ImGui::Button("as it is")) edited_ = is;
  if (changes.empty()) return;
  ImGui::SameLine();
  ImGui::TextUnformatted(changes_stiffness(is, *edited_) ? "takes a new base" : "at once");
}

void Window::apply() {
  if (!edited_) return;
  const std::vector<std::string> changes = changes_of(edit_of(problem()), *edited_);
  if (!changes.empty()) live_.post(input::Set{changes});
}

}  // namespace sunder::app
