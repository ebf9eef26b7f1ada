// SPDX-License-Identifier: Apache-2.0
#include "app/view/look.hpp"

#include "app/figure/shading.hpp"
#include "sunder/simulation.hpp"

namespace sunder::app {

bool set(Look& look, const Input& input) {
  if (const auto* camera = std::get_if<input::Camera>(&input.what)) {
    look.camera = *camera;
  } else if (const auto* at = std::get_if<input::Look>(&input.what)) {
    look.at = at->at;
  } else if (const auto* colour = std::get_if<input::Colour>(&input.what)) {
    look.colour = *colour;
  } else if (const auto* clip = std::get_if<input::Clip>(&input.what)) {
    look.clip = *clip;
  } else if (const auto* show = std::get_if<input::Show>(&input.what)) {
    using What = input::Show::What;
    bool& which = show->what == What::wireframe ? look.wireframe
                  : show->what == What::arrows  ? look.arrows
                  : show->what == What::tips    ? look.tips
                  : show->what == What::fibres  ? look.fibres
                  : show->what == What::text    ? look.text
                                                : look.pictures;
    which = show->on;
  } else {
    return false;
  }
  return true;
}

Field standard_field(const Problem& problem) {
  if (!needs_of(problem).stress) return Field::strain;
  return breaks_by_strength(problem) ? Field::yield : Field::stress;
}

}  // namespace sunder::app
