// SPDX-License-Identifier: Apache-2.0
// Every wrong call gives its status and a sentence, none ends the process. Run under the address
// and undefined behaviour sanitizers.
#include <cmath>

#include "api/misuse.hpp"

namespace sunder::test {
namespace {

TEST(CNotFinite, IsNoMatterWhereItIsNotRead) {
  World w;
  EXPECT_OK(w.add_instrument([](sunder_instrument& i) {
    std::fill_n(i.at, 3, kNaN);
    std::fill_n(i.ramp, 2, kNaN);
  }));
  EXPECT_OK(w.add_support([](sunder_support& s) {
    static const std::int32_t ids[] = {0};
    s.nodes.kind = SUNDER_SELECT_IDS;
    s.nodes.ids = ids;
    s.nodes.id_count = 1;
    s.nodes.radius = s.nodes.min[0] = s.nodes.max[1] = kNaN;
  }));
  EXPECT_OK(w.set_fracture([](sunder_fracture_options& f) { f.plane_normal[0] = kNaN; }));
  EXPECT_OK(w.add_crack([](sunder_preset_crack& c) {
    c.has_mouth = 1;
    c.tips[1][0] = kNaN;
  }));
}

std::vector<Misuse> all() {
  std::vector<Misuse> list;
  for (const auto& part :
       {handles(), null_pointers(), sizes(), struct_sizes(), values(), not_finite(), scenes(),
        order(), live_pointers(), live_counts(), live_values()}) {
    list.insert(list.end(), part.begin(), part.end());
  }
  return list;
}

class CMisuse : public testing::TestWithParam<Misuse> {};

TEST_P(CMisuse, GivesAStatusAndASentence) {
  World world;
  const sunder_status status = GetParam().call(world);
  EXPECT_EQ(status, GetParam().status) << sunder_status_text(status);
  const std::string text = sunder_last_error();
  EXPECT_FALSE(text.empty());
  EXPECT_NE(text.find(GetParam().says), std::string::npos) << text;
  for (const char* word :
       {"()", "::", "Problem", "Backend", "Needs", "Simulation", "Error", "std"}) {
    EXPECT_EQ(text.find(word), std::string::npos) << "a caller in C has none of C++: " << text;
  }
}

INSTANTIATE_TEST_SUITE_P(Table, CMisuse, testing::ValuesIn(all()),
                         [](const auto& test) { return std::string(test.param.name); });

// What a host's mesh may hold beside the body: nodes that nothing uses keep their ids and stay in
// place, elements of a left-handed host are turned; one warning each, the fields as without.
TEST(COddMesh, IsUsedWithAWarning) {
  World world;
  const auto field = [&](const Arrays& arrays, std::int32_t* warnings) {
    EXPECT_OK(world.set_mesh(arrays));
    sunder_simulation simulation = nullptr;
    EXPECT_OK(sunder_simulation_create(world.scene, nullptr, &simulation));
    sunder_step step{};
    step.struct_size = sizeof step;
    EXPECT_OK(sunder_simulation_step(simulation, &step));
    std::vector<double> u(arrays.nodes.size());
    EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
    EXPECT_OK(sunder_simulation_warning_count(simulation, warnings));
    EXPECT_OK(sunder_simulation_destroy(simulation));
    return u;
  };
  std::int32_t plain = 0, odd = 0;
  const std::vector<double> expected = field(world.arrays, &plain);
  Arrays arrays = world.arrays;
  arrays.nodes.insert(arrays.nodes.end(), {1e6, 0, 0});
  for (std::size_t t = 0; t < arrays.tets.size(); t += 4)
    std::swap(arrays.tets[t], arrays.tets[t + 1]);
  const std::vector<double> u = field(arrays, &odd);
  EXPECT_EQ(odd, plain + 1);
  double largest = 0;
  for (const double x : expected) largest = std::max(largest, std::abs(x));
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LE(std::abs(u[i] - expected[i]), 1e-9 * largest) << i;
  for (std::size_t i = expected.size(); i < u.size(); ++i) EXPECT_EQ(u[i], 0);
}

/// What is said of the body of a scene.
std::string warnings_of_body(sunder_scene scene) {
  sunder_simulation simulation = nullptr;
  EXPECT_OK(sunder_simulation_create(scene, nullptr, &simulation));
  const std::string all = warnings_of(simulation);
  EXPECT_OK(sunder_simulation_destroy(simulation));
  return all;
}

TEST(COddMesh, OfADuplicateAndOfALooseBodySaysWhereTheyAre) {
  World world;
  EXPECT_EQ(warnings_of_body(world.scene), "");
  Arrays arrays = world.arrays;
  const auto count = arrays.tets.size() / 4;
  arrays.tets.insert(arrays.tets.end(),
                     {arrays.tets[0], arrays.tets[1], arrays.tets[2], arrays.tets[3]});
  EXPECT_OK(world.set_mesh(arrays));
  const std::string twice = warnings_of_body(world.scene);
  EXPECT_NE(twice.find("1 element"), std::string::npos) << twice;
  EXPECT_NE(twice.find("the same four nodes"), std::string::npos) << twice;
  EXPECT_NE(twice.find(std::to_string(count)), std::string::npos) << twice;

  arrays = world.arrays;
  const auto node = static_cast<std::int32_t>(arrays.nodes.size() / 3);
  arrays.nodes.insert(arrays.nodes.end(), {50, 50, 0, 51, 50, 0, 50, 51, 0, 50, 50, 1});
  arrays.tets.insert(arrays.tets.end(), {node, node + 1, node + 2, node + 3});
  EXPECT_OK(world.set_mesh(arrays));
  const std::string loose = warnings_of_body(world.scene);
  EXPECT_NE(loose.find("nothing holds or drives"), std::string::npos) << loose;
}

TEST(CMisuseTable, HasAtLeastAHundredCalls) { EXPECT_GE(all().size(), 100u); }

}  // namespace
}  // namespace sunder::test
