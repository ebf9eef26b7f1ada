// SPDX-License-Identifier: Apache-2.0
// Fibres that are refused: each with the sentence that says why.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "fibre_cubes.hpp"
#include "sunder/error.hpp"
#include "support/text.hpp"

namespace sunder::test {
namespace {

void expect_refused(const Scene& scene, const std::string& text) {
  try {
    const Problem problem(scene);
    ADD_FAILURE() << "took it: " << text;
  } catch (const InputError& error) {
    EXPECT_TRUE(mentions(error.what(), text)) << error.what();
  }
}

Scene odd(const std::function<void(Scene&, Material&, Fibres&)>& change, bool linear = false) {
  Scene scene = linear ? linear_cube() : cube();
  if (!linear) scene.materials["board"].fibres = {at_angle(0)};
  Material& m = scene.materials["board"];
  change(scene, m, m.fibres[0]);
  return scene;
}

TEST(Fibres, BadInputIsRefused) {
  using S = Scene;
  using M = Material;
  using F = Fibres;
  expect_refused(odd([](S&, M&, F& f) { f.direction = Vec3(0, 0, 0); }),
                 "fibres 0 has direction = [0, 0, 0]; it must be finite and not zero");
  expect_refused(odd([](S&, M&, F& f) {
                   f.direction = AroundAxis{Vec3::Zero(), Vec3::Zero()};
                 }),
                 "the axis not zero");
  expect_refused(odd([](S& s, M&, F& f) {
                   Vec3 centroid = Vec3::Zero();
                   for (const Index n : s.mesh.tets[5]) centroid += s.mesh.nodes[n] / 4;
                   f.direction = AroundAxis{centroid - Vec3(0, 0, 3), Vec3(0, 0, 1)};
                 }),
                 "has the centroid of element");
  expect_refused(odd([](S&, M&, F& f) { f.direction = AlongCurve{{Vec3(1, 2, 3)}}; }),
                 "has a curve of 1 point; it needs two or more");
  expect_refused(odd([](S&, M&, F& f) {
                   f.direction = AlongCurve{{Vec3(1, 2, 3), Vec3(2, 2, 3), Vec3(2, 2, 3)}};
                 }),
                 "has a curve whose point 2, [2, 2, 3], is not finite or the one before once more");
  expect_refused(odd([](S&, M&, F& f) {
                   f.direction = AlongSurface{"skin", Vec3(1, 0, 0)};
                 }),
                 "has surface = \"skin\", which the mesh has not; it has none");
  expect_refused(odd([](S& s, M&, F& f) {
                   s.mesh.surfaces.push_back({"skin", 1, {{0, 1, 3}}});
                   f.direction = AlongSurface{"skin", Vec3(0, 0, 2)};
                 }),
                 "has direction = [0, 0, 2], which is across surface \"skin\" at element 0");
  expect_refused(odd([](S&, M&, F& f) { f.direction = FieldName{"helix"}; }),
                 "field = \"helix\", which is no vector of the mesh's cells; its file has none");
  expect_refused(odd([](S& s, M&, F& f) {
                   f.direction = FieldName{"helix"};
                   s.mesh.fields["other"].assign(s.mesh.tets.size(), Vec3(1, 0, 0));
                 }),
                 "it has \"other\"");
  expect_refused(odd([](S& s, M&, F& f) {
                   f.direction = FieldName{"helix"};
                   s.mesh.fields["helix"].assign(3, Vec3(1, 0, 0));
                 }),
                 "has 3 vectors for 48 elements");
  expect_refused(odd([](S& s, M&, F& f) {
                   f.direction = FieldName{"helix"};
                   s.mesh.fields["helix"].assign(s.mesh.tets.size(), Vec3(1, 0, 0));
                   s.mesh.fields["helix"][4].setZero();
                 }),
                 "in field \"helix\" at element 4");
  expect_refused(odd([](S&, M&, F& f) { f.k1 = {}; }), "lacks k1");
  expect_refused(odd([](S&, M&, F& f) { f.k1 = 0; }), "k1 = 0; it must be finite and above 0 MPa");
  expect_refused(odd([](S&, M&, F& f) { f.k2 = {}; }), "lacks k2");
  expect_refused(odd([](S&, M&, F& f) { f.k2 = -1; }), "k2 = -1; it must be finite and at least 0");
  for (const double kappa : {-0.01, 0.34, std::nan("")}) {
    expect_refused(odd([&](S&, M&, F& f) { f.dispersion = kappa; }),
                   "it must lie between 0 (all along) and 1/3");
  }
  expect_refused(odd([](S&, M&, F& f) { f.young_along = 3; }), "which is for law \"linear\"");
  expect_refused(odd([](S&, M& m, F&) { m.fibres.resize(3, m.fibres[0]); }), "at most 2");
  expect_refused(odd([](S& s, M&, F&) { s.fracture.model = FractureModel::b; }),
                 "of whose stiffness model \"B\" knows nothing");
  expect_refused(odd([](S&, M& m, F& f) { m.fibres.push_back(f); }, true),
                 "law \"linear\" takes one");
  expect_refused(odd([](S&, M&, F& f) { f.k1 = 1; }, true),
                 "k1, k2 or dispersion, which are for laws of finite deformation");
  expect_refused(odd([](S&, M&, F& f) { f.young_along = {}; }, true), "lacks young_along");
  expect_refused(odd([](S&, M&, F& f) { f.poisson_along = {}; }, true), "lacks poisson_along");
  expect_refused(odd([](S&, M&, F& f) { f.shear_along = {}; }, true), "lacks shear_along");
  expect_refused(odd([](S&, M&, F& f) { f.young_along = -1; }, true), "young_along = -1");
  expect_refused(odd([](S&, M&, F& f) { f.shear_along = 0; }, true), "shear_along = 0");
  expect_refused(odd([](S&, M&, F& f) { f.poisson_along = 1.9; }, true),
                 "some deformation would set energy free");
}

TEST(Fibres, BadStrengthIsRefused) {
  const auto weak = [](Material& m, Fibres& f) {
    m.yield = 2;
    f.yield_across = 1;
  };
  expect_refused(odd(
                     [&](Scene&, Material& m, Fibres& f) {
                       weak(m, f);
                       f.yield_across = 0;
                     },
                     true),
                 "yield_across = 0; it must be finite and above 0 MPa");
  expect_refused(odd([](Scene&, Material&, Fibres& f) { f.yield_across = 1; }, true),
                 "but its material no yield");
  expect_refused(odd([&](Scene&, Material& m, Fibres& f) {
                   weak(m, f);
                   m.fibres.push_back(m.fibres[0]);
                 }),
                 "beside another family");
  expect_refused(
      odd([&](Scene&, Material& m, Fibres& f) { weak(m, f); }),
      "law \"neo-hookean\" judges in the material's frame; take fracture.stress = \"biot\"");
  expect_refused(odd(
                     [&](Scene& s, Material& m, Fibres& f) {
                       weak(m, f);
                       s.fracture.averaging = 1;
                     },
                     true),
                 "leave fracture.averaging out");
}

TEST(Fibres, BadToughnessIsRefused) {
  // Of model B, whose fibres have no stiffness.
  const auto guided = [](const std::function<void(Scene&, Material&, Fibres&)>& change) {
    return odd(
        [&](Scene& s, Material& m, Fibres& f) {
          s.fracture.model = FractureModel::b;
          s.fracture.sif = SifSource::field;
          s.fracture.plane_normal = Vec3(0, 0, 1);
          m.toughness = 1;
          f = Fibres{};
          f.direction = Vec3(1, 0, 0);
          f.toughness_across = 2;
          change(s, m, f);
        },
        true);
  };
  const Problem good(guided([](Scene&, Material&, Fibres&) {}));
  EXPECT_TRUE(good.guides_cracks());
  EXPECT_FALSE(good.fibrous());
  EXPECT_EQ(good.fibre_families(), 1);
  EXPECT_EQ(good.fibre_direction(3, 0), Vec3(1, 0, 0));
  using S = Scene;
  using M = Material;
  using F = Fibres;
  for (const double value : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    expect_refused(guided([&](S&, M&, F& f) { f.toughness_across = value; }),
                   "it must be finite and above 0 MPa sqrt(mm)");
  }
  expect_refused(guided([](S&, M& m, F&) {
                   m.toughness = {};
                   m.energy = 1;
                 }),
                 "has toughness_across, but its material no toughness, which holds along them");
  expect_refused(guided([](S&, M&, F& f) { f.energy_across = 1; }),
                 "has energy_across, but its material no energy");
  expect_refused(guided([](S&, M&, F& f) { f.young_along = 15; }),
                 "has toughness_across beside a stiffness or a strength by direction");
  expect_refused(guided([](S&, M& m, F& f) {
                   m.yield = 1;
                   f.yield_across = 1;
                 }),
                 "beside a stiffness or a strength");
  expect_refused(guided([](S&, M& m, F& f) { m.fibres.push_back(f); }),
                 "where they guide cracks it has one");
  expect_refused(guided([](S& s, M&, F&) { s.fracture.model = FractureModel::a; }),
                 "which model \"A\" does not read; take model \"B\"");
  expect_refused(guided([](S& s, M&, F&) { s.fracture.sif = SifSource::formula; }),
                 "take fracture.sif = \"field\"");
  expect_refused(guided([](S&, M&, F& f) { f.direction = Vec3::Zero(); }),
                 "it must be finite and not zero");
}

}  // namespace
}  // namespace sunder::test
