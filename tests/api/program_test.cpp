// SPDX-License-Identifier: Apache-2.0
// A scene through the C interface gives the program's results bit for bit: fields of result.vtu,
// rows of events.csv.
#include <charconv>
#include <cstring>

#include "api/c_scene.hpp"
#include "app/input/scene_toml.hpp"
#include "app/output/program.hpp"
#include "app/output/xml_file.hpp"

namespace sunder::test {
namespace {

/// Selections of a checked problem as ids, and everything else, through the C interface.
class Translation {
 public:
  explicit Translation(const Problem& problem) : problem_(problem), scene_(problem.scene()) {
    EXPECT_OK(sunder_scene_create(&handle));
    mesh();
    supports();
    instruments();
    cracks();
    options();
  }
  ~Translation() { EXPECT_OK(sunder_scene_destroy(handle)); }
  Translation(const Translation&) = delete;
  Translation& operator=(const Translation&) = delete;

  sunder_scene handle = nullptr;

 private:
  static sunder_selection ids(const std::vector<Index>& list) {
    sunder_selection s{};
    s.ids = list.data();
    s.id_count = list.size();
    return s;
  }

  void mesh() {
    std::vector<double> nodes;
    std::vector<std::int32_t> tets;
    for (const Vec3& x : scene_.mesh.nodes) nodes.insert(nodes.end(), x.data(), x.data() + 3);
    for (const auto& t : scene_.mesh.tets) tets.insert(tets.end(), t.begin(), t.end());
    EXPECT_OK(sunder_scene_set_mesh(handle, nodes.data(), nodes.size(), tets.data(), tets.size(),
                                    scene_.mesh.volume_of.data(), scene_.mesh.volume_of.size()));
    for (const NamedVolume& volume : scene_.mesh.volumes) {
      const Material& material = scene_.materials.at(volume.name);
      sunder_material m;
      sunder_material_init(&m);
      m.young = material.young;
      m.poisson = material.poisson;
      m.yield = material.yield.value_or(0.0);
      EXPECT_OK(sunder_scene_add_material(handle, &m, nullptr));
    }
  }

  void supports() {
    for (const Support& support : scene_.supports) {
      sunder_support s;
      sunder_support_init(&s);
      s.axes = support.axes.bits;
      const auto& area = std::get<Box>(support.nodes);
      s.nodes.kind = SUNDER_SELECT_BOX;
      std::copy_n(area.min.data(), 3, s.nodes.min);
      std::copy_n(area.max.data(), 3, s.nodes.max);
      EXPECT_OK(sunder_scene_add_support(handle, &s));
    }
  }

  void instruments() {
    for (std::size_t i = 0; i < scene_.instruments.size(); ++i) {
      const Instrument& tool = scene_.instruments[i];
      sunder_instrument c;
      sunder_instrument_init(&c);
      c.name = tool.name.c_str();
      c.nodes = ids(problem_.instrument_nodes()[i].nodes);
      if (const auto* pull = std::get_if<Pull>(&tool.action)) {
        std::copy_n(pull->force.data(), 3, c.value);
      } else if (const auto* grip = std::get_if<Grip>(&tool.action)) {
        c.kind = SUNDER_DISPLACEMENT;
        c.axes = grip->axes.bits;
        std::copy_n(grip->displacement.data(), 3, c.value);
      } else {
        const auto& press = std::get<Press>(tool.action);
        c.kind = SUNDER_PRESSURE;
        c.side = static_cast<std::int32_t>(press.side);
        c.crack = press.crack;
        std::copy_n(press.at.data(), 3, c.at);
        std::copy_n(press.force.data(), 3, c.value);
      }
      if (tool.ramp) {
        c.has_ramp = 1;
        c.ramp[0] = tool.ramp->begin;
        c.ramp[1] = tool.ramp->end;
      }
      EXPECT_OK(sunder_scene_add_instrument(handle, &c, nullptr));
    }
  }

  void cracks() {
    for (std::size_t i = 0; i < scene_.cracks.size(); ++i) {
      const PresetCrack& crack = scene_.cracks[i];
      sunder_preset_crack c;
      sunder_preset_crack_init(&c);
      c.elements = ids(problem_.crack_elements()[i]);
      c.has_mouth = crack.mouth ? 1 : 0;
      if (crack.mouth) std::copy_n(crack.mouth->data(), 3, c.mouth);
      for (std::size_t t = 0; t < crack.tips.size(); ++t) {
        std::copy_n(crack.tips[t].data(), 3, c.tips[t]);
      }
      EXPECT_OK(sunder_scene_add_crack(handle, &c));
    }
    for (std::size_t r = 0; r < scene_.removals.size(); ++r) {
      const sunder_selection elements = ids(problem_.removal_elements()[r]);
      EXPECT_OK(sunder_scene_add_removal(handle, scene_.removals[r].step, &elements));
    }
  }

  void options() {
    const FractureOptions& f = scene_.fracture;
    sunder_fracture_options c;
    sunder_fracture_options_init(&c);
    c.model = static_cast<std::int32_t>(f.model);
    c.alpha = f.alpha;
    c.yield_measure = static_cast<std::int32_t>(f.yield_measure);
    c.sigma0 = static_cast<std::int32_t>(f.sigma0);
    c.crack_length = static_cast<std::int32_t>(f.crack_length);
    c.birth = static_cast<std::int32_t>(f.birth);
    c.sif = static_cast<std::int32_t>(f.sif);
    c.max_events = f.max_events;
    EXPECT_OK(sunder_scene_set_fracture(handle, &c));
    auto solver = on(SUNDER_BACKEND_CPU);
    solver.tolerance = scene_.solver.tolerance;
    EXPECT_OK(sunder_scene_set_solver(handle, &solver));
    EXPECT_OK(sunder_scene_set_steps(handle, scene_.steps));
  }

  const Problem& problem_;
  const Scene& scene_;
};

double number(const std::string& text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

void expect_row(const sunder_event& event, const std::vector<std::string>& row) {
  static const char* const causes[] = {"mss", "sif", "preset", "script"};
  EXPECT_EQ(std::to_string(event.step), row[0]);
  EXPECT_EQ(std::to_string(event.event), row[1]);
  EXPECT_EQ(std::to_string(event.element), row[2]);
  EXPECT_EQ(causes[event.cause], row[3]);
  EXPECT_EQ(event.crack < 0 ? "" : std::to_string(event.crack), row[4]);
  EXPECT_EQ(event.ratio, number(row[5]));
  EXPECT_EQ(event.load_factor, number(row[6]));
  if (event.has_sif) {
    const double terms[] = {event.k,     event.k_a,    event.k_b,  event.k_c, event.theta,
                            event.reach, event.sigma0, event.beta, event.a,   event.b};
    for (std::size_t t = 0; t < std::size(terms); ++t) EXPECT_EQ(terms[t], number(row[8 + t])) << t;
  }
}

class CProgram : public testing::TestWithParam<const char*> {};

TEST_P(CProgram, GivesTheSameBits) {
  const std::string path = std::string(SUNDER_SCENES "/") + GetParam() + ".toml";
  const std::vector<std::string> overrides = {"time.steps=20"};
  const TempFolder folder;
  const Outcome run = run_program({"run", path, "--backend", "cpu", "--set", overrides[0], "--out",
                                   (folder / "out").string(), "--quiet"});
  ASSERT_EQ(run.exit_code, 0) << run.err;

  const auto problem = app::read_problem(path, overrides);
  const Translation translation(*problem);
  sunder_simulation simulation = nullptr;
  ASSERT_OK(sunder_simulation_create(translation.handle, nullptr, &simulation));
  for (int i = 0; i < problem->scene().steps; ++i) {
    ASSERT_OK(sunder_simulation_step(simulation, nullptr));
  }
  std::vector<double> u(3 * problem->mesh().nodes.size()), s(6 * problem->mesh().tets.size());
  ASSERT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
  ASSERT_OK(sunder_simulation_stress(simulation, s.data(), s.size()));

  const XmlElement vtu = parse_xml(read_file(folder / "out" / "result.vtu"));
  const XmlElement& piece = vtu.child("UnstructuredGrid").child("Piece");
  EXPECT_EQ(u, values_of<double>(piece.child("PointData").child("DataArray", "displacement")));
  EXPECT_EQ(s, values_of<double>(piece.child("CellData").child("DataArray", "stress")));

  const auto rows = read_csv(folder / "out" / "events.csv");
  std::int32_t count = 0;
  ASSERT_OK(sunder_simulation_event_count(simulation, &count));
  ASSERT_EQ(static_cast<std::size_t>(count) + 1, rows.size());
  EXPECT_GT(count, 0) << "a scene in which nothing breaks shows little";
  for (std::int32_t i = 0; i < count; ++i) {
    sunder_event event{};
    event.struct_size = sizeof event;
    ASSERT_OK(sunder_simulation_event_at(simulation, i, &event));
    expect_row(event, rows[static_cast<std::size_t>(i) + 1]);
  }
  EXPECT_OK(sunder_simulation_destroy(simulation));
}

INSTANTIATE_TEST_SUITE_P(Scenes, CProgram,
                         testing::Values("board-grip-b", "board-pull-a", "board-pull-b", "notch-b",
                                         "pressure-near", "scripted-cut"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace sunder::test
