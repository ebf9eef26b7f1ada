// SPDX-License-Identifier: Apache-2.0
#include "fracture/finding.hpp"

#include "sunder/in_quotes.hpp"

namespace sunder {
namespace {

std::string closing_push(const Instrument& instrument, int crack) {
  const bool upper = std::get<Press>(instrument.action).side == CrackSide::upper;
  return "instrument " + in_quotes(instrument.name) + " pushes crack " + std::to_string(crack) +
         " shut on its " + (upper ? "upper" : "lower") +
         " face and counts as no pressure in its stress intensity";
}

std::string removed_before(const Finding& f) {
  return "destroy " + std::to_string(f.subject) + " in step " + std::to_string(f.detail) + ": " +
         std::to_string(f.count) + " of its elements " + (f.count == 1 ? "was" : "were") +
         " destroyed already";
}

std::string field_of(const Finding& f) {
  return "the field K of crack " + std::to_string(f.subject) + " at its tip " +
         std::to_string(f.detail);
}

std::string formula_of(const Finding& f) {
  return "the formula's K of crack " + std::to_string(f.subject);
}

}  // namespace

std::string sentence(const Finding& f, const Scene& scene) {
  switch (f.kind) {
    case Finding::Kind::closing_push:
      return closing_push(scene.instruments[static_cast<std::size_t>(f.subject)], f.detail);
    case Finding::Kind::nothing_to_press:
      return "instrument " +
             in_quotes(scene.instruments[static_cast<std::size_t>(f.subject)].name) +
             " finds no node of its crack's face to press on and does not act";
    case Finding::Kind::removed_before:
      return removed_before(f);
    case Finding::Kind::field_fixed:
      return field_of(f) + " reaches fixed nodes, whose reactions it leaves out";
    case Finding::Kind::field_material:
      return field_of(f) +
             " reaches another material: it is that of one body with the mean compliance around "
             "the tip";
    case Finding::Kind::field_damage:
      return field_of(f) +
             " reaches elements destroyed by something else: it is not separated from their field";
    case Finding::Kind::field_strain:
      return field_of(f) +
             " has no K: what surrounds the tip is strained by over 10 % or turned in itself by "
             "over 10 degrees; J, which is measured there too, takes its place as sqrt(J E') "
             "(docs/method.md)";
    case Finding::Kind::field_notch:
      return field_of(f) +
             " is not measured: the notch of the mesh's shape is too wide there for a sharp "
             "crack's K within 3 %; make it narrower (a slot under a fifteenth of its length, a V "
             "of "
             "at most 60 degrees, less under shear or inside the body), split the mesh's nodes, or "
             "let the crack take elements (docs/method.md)";
    case Finding::Kind::field_coarse:
      return field_of(f) +
             " is not measured: the mesh is too coarse for K within 3 % at the tip of the notch "
             "that belongs to its shape; make its elements there and ahead of it smaller "
             "(docs/method.md)";
    case Finding::Kind::field_split:
      return field_of(f) +
             " is more than 3 % low: the mesh's nodes are split up to there, and linear elements "
             "hold such a tip too stiffly; make them smaller there, or let the crack take elements "
             "(docs/method.md)";
    case Finding::Kind::formula_notch:
      return formula_of(f) +
             " is left out: its remote stress is that of the mesh without the crack's elements, "
             "and crack " +
             std::to_string(f.subject) +
             " is a notch of the mesh's shape; take fracture.sif = \"field\", or let the crack "
             "take elements";
    case Finding::Kind::formula_split:
      return formula_of(f) +
             " takes its remote stress from a mesh whose nodes are split along the crack, beside "
             "which there is hardly any; take fracture.sif = \"field\", or let the crack take "
             "elements";
    case Finding::Kind::nodes_spent:
      return "as many nodes have come as fracture.max_new_nodes allows: tips rest from here on; "
             "raise it";
    case Finding::Kind::lips_overlap:
      return "the lips of crack " + std::to_string(f.subject) +
             " pass through each other where they close; fracture.contact = true keeps them apart";
    case Finding::Kind::lips_unsettled:
      return "step " + std::to_string(f.subject) +
             ": which lips of split cracks touch had not settled after twenty solutions; they may "
             "overlap there";
  }
  return {};
}

}  // namespace sunder
