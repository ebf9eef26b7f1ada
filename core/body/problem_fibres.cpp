// SPDX-License-Identifier: Apache-2.0
// The fibres of a problem: what its materials may have, and where they run in each element.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "body/fibre_directions.hpp"
#include "material/fibres.hpp"
#include "material/linear.hpp"
#include "sunder/error.hpp"
#include "sunder/fracture_model.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/problem.hpp"
#include "sunder/scene_keys.hpp"
#include "sunder/words.hpp"

namespace sunder {
namespace {

constexpr std::size_t kMostFamilies = 2;

[[noreturn]] void refuse(InputFault fault, const std::string& text) {
  throw InputError(fault, text);
}

/// "material "x", fibres 1"
std::string name_of(const std::string& material, std::size_t family) {
  return "material " + in_quotes(material) + ", fibres " + std::to_string(family);
}

void check_finite_law(const std::string& what, const Fibres& f) {
  for (const auto& [key, value] :
       {std::pair("young_along", &f.young_along), std::pair("poisson_along", &f.poisson_along),
        std::pair("shear_along", &f.shear_along)}) {
    if (*value) {
      refuse(InputFault::out_of_range,
             what + " has " + key + ", which is for law \"linear\"; take k1, k2 and dispersion");
    }
  }
  for (const auto& [key, value] : {std::pair("k1", &f.k1), std::pair("k2", &f.k2)}) {
    if (!*value) {
      refuse(InputFault::missing_key,
             what + " lacks " + key + ", which laws of finite deformation need");
    }
  }
  if (!(*f.k1 > 0) || !std::isfinite(*f.k1)) {
    refuse(InputFault::out_of_range,
           what + " has k1 = " + in_digits(*f.k1) + "; it must be finite and above 0 MPa");
  }
  if (!(*f.k2 >= 0) || !std::isfinite(*f.k2)) {
    refuse(InputFault::out_of_range,
           what + " has k2 = " + in_digits(*f.k2) + "; it must be finite and at least 0");
  }
  if (!(f.dispersion >= 0 && f.dispersion <= 1.0 / 3)) {
    refuse(InputFault::out_of_range, what + " has dispersion = " + in_digits(f.dispersion) +
                                         "; it must lie between 0 (all along) and 1/3 (as many in "
                                         "every direction)");
  }
}

void check_linear_law(const std::string& what, const Material& m, const Fibres& f) {
  if (f.k1 || f.k2 || f.dispersion != 0) {
    refuse(InputFault::out_of_range,
           what +
               " has k1, k2 or dispersion, which are for laws of finite deformation; take "
               "young_along, poisson_along and shear_along, or law \"neo-hookean\"");
  }
  for (const auto& [key, value] :
       {std::pair("young_along", &f.young_along), std::pair("shear_along", &f.shear_along)}) {
    if (!*value) {
      refuse(InputFault::missing_key, what + " lacks " + key + ", which law \"linear\" needs");
    }
    if (!(**value > 0) || !std::isfinite(**value)) {
      refuse(InputFault::out_of_range, what + " has " + key + " = " + in_digits(**value) +
                                           "; it must be finite and above 0 MPa");
    }
  }
  if (!f.poisson_along) {
    refuse(InputFault::missing_key, what + " lacks poisson_along, which law \"linear\" needs");
  }
  const double nu = *f.poisson_along;
  const double left = 1 - m.poisson - 2 * nu * nu * m.young / *f.young_along;
  if (!(left > 0)) {
    refuse(
        InputFault::out_of_range,
        what + " has poisson_along = " + in_digits(nu) +
            ", with which some deformation would set energy free: 1 - poisson - 2 poisson_along^2 "
            "young / young_along is " +
            in_digits(left) + " and must be above 0");
  }
}

void check_strength(const std::string& what, const Scene& scene, const Material& m,
                    const Fibres& f) {
  if (!f.yield_across) return;
  const std::string has = what + " has yield_across";
  if (!(*f.yield_across > 0) || !std::isfinite(*f.yield_across)) {
    refuse(InputFault::out_of_range,
           has + " = " + in_digits(*f.yield_across) + "; it must be finite and above 0 MPa");
  }
  if (!m.yield) {
    refuse(InputFault::missing_key, has + ", but its material no yield, which holds along them");
  }
  if (m.fibres.size() > 1) {
    refuse(InputFault::out_of_range, has + " beside another family; take one, or leave it out");
  }
  if (m.law != MaterialLaw::linear && scene.fracture.stress == StressMeasure::cauchy) {
    refuse(InputFault::out_of_range,
           has + ", which law " +
               in_quotes(key_words("material", "law")[static_cast<std::size_t>(m.law)]) +
               " judges in the material's frame; take fracture.stress = \"biot\"");
  }
  if (scene.fracture.averaging > 0) {
    refuse(InputFault::out_of_range,
           has + ", which is judged by element; leave fracture.averaging out");
  }
}

/// Of normal strains in the fibre's frame, whose first axis is along.
Mat3 compliance_along(const Material& m, const Fibres& f) {
  const double along = *f.young_along, nu = *f.poisson_along;
  Mat3 compliance;
  compliance << 1 / along, -nu / along, -nu / along,   //
      -nu / along, 1 / m.young, -m.poisson / m.young,  //
      -nu / along, -m.poisson / m.young, 1 / m.young;
  return compliance;
}

/// What the fibres of a material are added to. Where patches share its volume their kappa is that
/// of an even stress, 1 over the sum of the compliances: D - kappa 1 1^T is then positive
/// semidefinite (Cauchy and Schwarz). With that of `young` and `poisson` it is not, and changes of
/// volume that even out over a patch would yield energy.
SmallStrain matrix_of(const Material& m) {
  SmallStrain of = small_strain(m);
  const bool shares = m.law == MaterialLaw::linear && m.volume == MaterialVolume::pooled;
  if (!shares || m.fibres.empty() || m.fibres.front().guide_cracks()) return of;
  const double kappa = 1 / compliance_along(m, m.fibres.front()).sum();
  of.triple_bulk = 3 * kappa;
  of.lambda = kappa - of.double_shear / 3;
  return of;
}

/// Spencer's constants by the elasticity in the fibre's frame.
AlongFibres along_fibres(const Material& m, const Fibres& f) {
  const Mat3 c = compliance_along(m, f).inverse();
  const SmallStrain across = matrix_of(m);
  AlongFibres of;
  of.alpha = c(0, 1) - c(1, 2);
  of.beta = c(0, 0) - c(1, 2) - 2 * of.alpha - 4 * *f.shear_along + 2 * across.mu;
  of.lambda = c(1, 2) - across.lambda;
  of.mu = *f.shear_along - across.mu;
  return of;
}

void check_toughness(const std::string& what, const Scene& scene, const Material& m,
                     const Fibres& f) {
  const struct {
    const char *key, *unit, *along;
    const std::optional<double>&across, &held;
  } all[] = {{"toughness_across", "MPa sqrt(mm)", "toughness", f.toughness_across, m.toughness},
             {"energy_across", "N/mm", "energy", f.energy_across, m.energy}};
  for (const auto& row : all) {
    if (!row.across) continue;
    const std::string has = what + " has " + row.key;
    if (!(*row.across > 0) || !std::isfinite(*row.across)) {
      refuse(InputFault::out_of_range,
             has + " = " + in_digits(*row.across) + "; it must be finite and above 0 " + row.unit);
    }
    if (!row.held) {
      refuse(InputFault::missing_key,
             has + ", but its material no " + row.along + ", which holds along them");
    }
    if (f.k1 || f.k2 || f.dispersion != 0 || f.young_along || f.poisson_along || f.shear_along ||
        f.yield_across) {
      refuse(InputFault::out_of_range,
             has +
                 " beside a stiffness or a strength by direction, with which the stress "
                 "intensity is not known; leave one of them out");
    }
    const FractureModelRow& model = row_of(scene.fracture.model);
    if (!model.grows_cracks) {
      refuse(InputFault::out_of_range,
             has + ", which model " + in_quotes(model.name) + " does not read; take model \"B\"");
    }
    if (scene.fracture.sif != SifSource::field) {
      refuse(InputFault::out_of_range,
             has + ", which takes K_I and K_II of the field; take fracture.sif = \"field\"");
    }
  }
}

/// Of one material.
void check_families(const std::string& name, const Material& m, const Scene& scene,
                    const Mesh& mesh) {
  const std::string of = "material " + in_quotes(name) + " has fibres";
  const bool linear = m.law == MaterialLaw::linear;
  const bool guide = std::ranges::any_of(m.fibres, &Fibres::guide_cracks);
  if (m.fibres.size() > (linear || guide ? 1 : kMostFamilies)) {
    refuse(InputFault::out_of_range, of + " of " + std::to_string(m.fibres.size()) + " families" +
                                         (guide    ? "; where they guide cracks it has one"
                                          : linear ? "; law \"linear\" takes one"
                                                   : "; a material has at most 2"));
  }
  const FractureModelRow& model = row_of(scene.fracture.model);
  if (model.grows_cracks && !guide) {
    refuse(InputFault::out_of_range,
           of + ", of whose stiffness model " + in_quotes(model.name) +
               " knows nothing: its stress intensity is that of isotropic bodies; take model "
               "\"A\" or \"P\", or fibres that have a toughness_across alone");
  }
  for (std::size_t i = 0; i < m.fibres.size(); ++i) {
    const std::string what = name_of(name, i);
    static_cast<void>(fem::directions_of(m.fibres[i], mesh, what));
    check_toughness(what, scene, m, m.fibres[i]);
    if (guide) continue;
    if (linear) {
      check_linear_law(what, m, m.fibres[i]);
    } else {
      check_finite_law(what, m.fibres[i]);
    }
    check_strength(what, scene, m, m.fibres[i]);
  }
}

/// Of every volume's families, by the names of their materials.
std::vector<std::vector<std::unique_ptr<fem::FibreDirections>>> all_directions(
    const Problem& problem) {
  const Mesh& mesh = problem.mesh();
  std::vector<std::vector<std::unique_ptr<fem::FibreDirections>>> all(mesh.volumes.size());
  for (std::size_t v = 0; v < all.size(); ++v) {
    const auto material = problem.scene().materials.find(mesh.volumes[v].name);
    if (material == problem.scene().materials.end()) continue;
    for (const Fibres& f : material->second.fibres) {
      all[v].push_back(fem::directions_of(f, mesh, name_of(material->first, all[v].size())));
    }
  }
  return all;
}

/// Of element e, by its material.
ElementFibres fibres_in(const Problem& problem, Index e,
                        std::span<const std::unique_ptr<fem::FibreDirections>> directions) {
  const Material& m = problem.material(e);
  ElementFibres of;
  for (const Fibres& f : m.fibres) {
    if (f.guide_cracks()) break;
    const auto place = static_cast<std::size_t>(of.count);
    FibreFamily& family = of.family[place];
    family.direction = directions[place]->in(e, problem.shape(e).volume);
    if (m.law == MaterialLaw::linear) {
      of.linear = along_fibres(m, f);
    } else {
      family.k1 = *f.k1;
      family.k2 = *f.k2;
      family.dispersion = f.dispersion;
    }
    ++of.count;
  }
  return of;
}

}  // namespace

void Problem::lay_fibres() {
  for (const auto& [name, material] : scene_.materials) {
    if (!material.fibres.empty()) check_families(name, material, scene_, mesh());
  }
  bool any = false, guide = false;
  for (const Index v : mesh().volume_of) {
    for (const Fibres& f : material_of_volume_[v]->fibres) {
      (f.guide_cracks() ? guide : any) = true;
    }
  }
  if (guide) lay_guides();
  if (!any) return;
  std::vector<ElementFibres> all;
  const auto directions = all_directions(*this);
  for (Index e = 0; e < tet_count(); ++e) {
    all.push_back(fibres_in(*this, e, directions[static_cast<std::size_t>(mesh().volume_of[e])]));
  }
  fibres_ = std::make_shared<const std::vector<ElementFibres>>(std::move(all));
  note_fibres();
}

/// Fibres that guide cracks; 0 where there are none.
void Problem::lay_guides() {
  std::vector<Vec3> all(static_cast<std::size_t>(tet_count()), Vec3::Zero());
  const auto directions = all_directions(*this);
  for (Index e = 0; e < tet_count(); ++e) {
    const Material& m = material(e);
    if (m.fibres.empty() || !m.fibres.front().guide_cracks()) continue;
    const auto& of = directions[static_cast<std::size_t>(mesh().volume_of[e])];
    all[static_cast<std::size_t>(e)] = of.front()->in(e, shape(e).volume);
  }
  guides_ = std::make_shared<const std::vector<Vec3>>(std::move(all));
}

void Problem::note_fibres() {
  small_strain_of_element_.clear();
  for (Index e = 0; fibres_ && e < tet_count(); ++e) {
    SmallStrain of = matrix_of(material(e));
    const ElementFibres& fibres = (*fibres_)[static_cast<std::size_t>(e)];
    if (fibres.count > 0) of.fibres = &fibres;
    small_strain_of_element_.push_back(of);
  }
}

int Problem::fibre_families() const {
  int most = guides_cracks() ? 1 : 0;
  for (Index e = 0; fibrous() && e < tet_count(); ++e) {
    most = std::max(most, (*fibres_)[static_cast<std::size_t>(e)].count);
  }
  return most;
}

Vec3 Problem::fibre_direction(Index e, int family) const {
  if (guides_cracks() && family == 0) return (*guides_)[static_cast<std::size_t>(e)];
  if (!fibrous()) return Vec3::Zero();
  return (*fibres_)[static_cast<std::size_t>(e)].family[static_cast<std::size_t>(family)].direction;
}

void Problem::take_fibres(const Problem& whole, std::span<const Index> elements) {
  fibres_ = whole.fibres_;
  guides_ = elements.empty() ? whole.guides_ : nullptr;  // nothing of a part alone breaks
  if (fibres_ && !elements.empty()) {
    std::vector<ElementFibres> some;
    for (Index e : elements) some.push_back((*fibres_)[static_cast<std::size_t>(e)]);
    fibres_ = std::make_shared<const std::vector<ElementFibres>>(std::move(some));
  }
  note_fibres();
}

}  // namespace sunder
