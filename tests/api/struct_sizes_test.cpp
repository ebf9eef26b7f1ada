// SPDX-License-Identifier: Apache-2.0
// Every struct with a struct_size, at every size that a caller may state: of its first version, of
// this one, of a later one, and never set.
#include <functional>

#include "api/c_interface.hpp"
#include "api/guarded_bytes.hpp"
#include "c/structs.hpp"

namespace sunder::test {

struct Grown {
  std::uint32_t struct_size;
  std::int32_t first;
  double second;
  double appended;
};

}  // namespace sunder::test

template <>
inline constexpr std::size_t sunder::c::kFirstSize<sunder::test::Grown> =
    offsetof(sunder::test::Grown, appended);

namespace sunder::test {
namespace {

constexpr std::uint32_t kLargestResult = 65536, kLargestOptions = 1024;

/// What the calls of the tables need: a torn board, and one with many steps to go.
struct World {
  sunder_scene scene = board_scene();
  sunder_plan plan = nullptr;
  sunder_simulation torn = board_simulation(), stepping = nullptr;
  sunder_grips grips = nullptr;
  sunder_frames frames = nullptr;

  World() {
    EXPECT_OK(sunder_plan_create(scene, &plan));
    for (int i = 0; i < 4; ++i) EXPECT_OK(sunder_simulation_step(torn, nullptr));
    EXPECT_OK(sunder_grips_create(torn, &grips));
    EXPECT_OK(sunder_frames_create(torn, SUNDER_FRAME_DESTROYED, nullptr, 0, &frames));
    EXPECT_OK(sunder_scene_set_steps(scene, 1000000));
    EXPECT_OK(sunder_simulation_create(scene, nullptr, &stepping));
  }
  ~World() {
    EXPECT_OK(sunder_plan_destroy(plan));
    EXPECT_OK(sunder_grips_destroy(grips));
    EXPECT_OK(sunder_frames_destroy(frames));
    EXPECT_OK(sunder_simulation_destroy(torn));
    EXPECT_OK(sunder_simulation_destroy(stepping));
    EXPECT_OK(sunder_scene_destroy(scene));
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;
};

struct Struct {
  const char* name;
  std::size_t now;
  std::size_t first;  // its size in its first version, on a machine of 64 bits
  std::function<sunder_status(World&, void*)> call;
};

void PrintTo(const Struct& s, std::ostream* out) { *out << s.name; }

template <class T>
T* as(void* bytes) {
  return static_cast<T*>(bytes);
}

std::vector<Struct> results() {
  return {
      {"device", sizeof(sunder_device), 816,
       [](World&, void* to) { return sunder_device_at(0, as<sunder_device>(to)); }},
      {"engine_of_plan", sizeof(sunder_engine), 1160,
       [](World& w, void* to) { return sunder_plan_engine(w.plan, as<sunder_engine>(to)); }},
      {"engine_of_simulation", sizeof(sunder_engine), 1160,
       [](World& w, void* to) { return sunder_simulation_engine(w.torn, as<sunder_engine>(to)); }},
      {"step", sizeof(sunder_step), 112,
       [](World& w, void* to) { return sunder_simulation_step(w.stepping, as<sunder_step>(to)); }},
      {"event", sizeof(sunder_event), 160,
       [](World& w, void* to) {
         return sunder_simulation_event_at(w.torn, 0, as<sunder_event>(to));
       }},
      {"body", sizeof(sunder_body), 24,
       [](World& w, void* to) { return sunder_simulation_body(w.torn, as<sunder_body>(to)); }},
      {"surface", sizeof(sunder_surface), 24,
       [](World& w, void* to) {
         return sunder_simulation_surface(w.torn, as<sunder_surface>(to));
       }},
      {"felt", sizeof(sunder_felt), 40,
       [](World& w, void* to) {
         return sunder_grips_feel(w.grips, nullptr, nullptr, 0, nullptr, 0, as<sunder_felt>(to));
       }},
      {"frame", sizeof(sunder_frame), 24,
       [](World& w, void* to) { return sunder_frames_take(w.frames, as<sunder_frame>(to)); }},
      {"crack", sizeof(sunder_crack), 160,
       [](World& w, void* to) {
         return sunder_simulation_crack_at(w.torn, 0, as<sunder_crack>(to));
       }},
      {"tip", sizeof(sunder_tip), 136,
       [](World& w, void* to) {
         int32_t count = 0;
         EXPECT_OK(sunder_simulation_measure_tips(w.torn, &count));
         EXPECT_GT(count, 0);
         return sunder_simulation_tip_at(w.torn, 0, as<sunder_tip>(to));
       }},
      {"interface", sizeof(sunder_interface), 96,
       [](World&, void* to) {
         const sunder_simulation joined = joined_cubes();
         const auto status = sunder_simulation_interface_at(joined, 0, as<sunder_interface>(to));
         EXPECT_OK(sunder_simulation_destroy(joined));
         return status;
       }},
  };
}

class CResultStruct : public testing::TestWithParam<Struct> {
 protected:
  sunder_status fill(GuardedBytes& bytes) { return GetParam().call(world, bytes.data()); }
  World world;
};

TEST_P(CResultStruct, IsFilledAsFarAsTheCallerKnowsIt) {
  for (const std::size_t size : {GetParam().first, GetParam().now}) {
    GuardedBytes bytes(size, static_cast<std::uint32_t>(size));
    EXPECT_OK(fill(bytes)) << size;
    EXPECT_FALSE(bytes.untouched_from(sizeof(std::uint32_t)));
  }
}

// A size that was never set may say anything, and the next page is not there.
TEST_P(CResultStruct, IsNotTouchedBeyondWhatThisVersionKnows) {
  const std::size_t now = GetParam().now;
  for (const std::uint32_t stated : {static_cast<std::uint32_t>(now) + 8, kLargestResult}) {
    GuardedBytes exact(now, stated), longer(now + 64, stated);
    EXPECT_OK(fill(exact));
    EXPECT_OK(fill(longer));
    EXPECT_TRUE(longer.untouched_from(now));
    std::uint32_t left = 0;
    std::memcpy(&left, longer.data(), sizeof left);
    EXPECT_EQ(left, stated) << "the caller's, for its next call";
  }
}

TEST_P(CResultStruct, IsRefusedUntouchedAtASizeOfNoVersion) {
  const auto first = static_cast<std::uint32_t>(GetParam().first);
  for (const std::uint32_t stated : {0u, 1u, first - 1, kLargestResult + 1, 0xcdcdcdcdu, ~0u}) {
    GuardedBytes bytes(GetParam().now, stated);
    EXPECT_EQ(fill(bytes), SUNDER_ERROR_STRUCT_SIZE) << stated;
    EXPECT_NE(std::string(sunder_last_error()).find("struct_size"), std::string::npos);
    EXPECT_TRUE(bytes.untouched_from(sizeof stated));
  }
}

INSTANTIATE_TEST_SUITE_P(All, CResultStruct, testing::ValuesIn(results()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(CResultStructs, OfAnOlderCallerAreFilledAsFarAsTheyGo) {
  const Grown value{sizeof(Grown), 7, 8.5, 9.5};
  constexpr std::size_t kOlder = offsetof(Grown, appended);
  GuardedBytes older(kOlder, kOlder);
  c::write_struct(as<Grown>(older.data()), value, "grown");
  Grown read{};
  std::memcpy(static_cast<void*>(&read), older.data(), kOlder);
  EXPECT_EQ(read.struct_size, kOlder);
  EXPECT_EQ(read.first, 7);
  EXPECT_EQ(read.second, 8.5);
}

/// A call with a struct that is `initial`, but for the size that its bytes state already.
template <class T>
std::function<sunder_status(World&, void*)> given(T (*initial)(),
                                                  sunder_status (*call)(World&, const T*)) {
  return [initial, call](World& w, void* bytes) {
    std::uint32_t stated = 0;
    std::memcpy(&stated, bytes, sizeof stated);
    T value = initial();
    value.struct_size = stated;
    if (stated > sizeof stated) {
      std::memcpy(bytes, &value, std::min<std::size_t>(stated, sizeof value));
    }
    return call(w, as<T>(bytes));
  };
}

sunder_material soft() {
  sunder_material m = SUNDER_MATERIAL_INIT;
  m.young = 5;
  return m;
}

sunder_fibres even() { return SUNDER_FIBRES_INIT; }
sunder_preset_crack notch() { return SUNDER_PRESET_CRACK_INIT; }
sunder_fracture_options tearing() { return model(SUNDER_FRACTURE_B); }
sunder_solver_options on_cpu() { return on(SUNDER_BACKEND_CPU); }
sunder_instrument pulling() { return corner_pull(); }
sunder_callbacks silent() { return SUNDER_CALLBACKS_INIT; }

std::vector<Struct> options() {
  return {
      {"material", sizeof(sunder_material), 40,
       given<sunder_material>(soft,
                              [](World& w, const sunder_material* m) {
                                return sunder_scene_add_material(w.scene, m, nullptr);
                              })},
      {"support", sizeof(sunder_support), 88,
       given<sunder_support>(
           top_support,
           [](World& w, const sunder_support* s) { return sunder_scene_add_support(w.scene, s); })},
      {"instrument", sizeof(sunder_instrument), 176,
       given<sunder_instrument>(pulling,
                                [](World& w, const sunder_instrument* i) {
                                  return sunder_scene_add_instrument(w.scene, i, nullptr);
                                })},
      {"preset_crack", sizeof(sunder_preset_crack), 160,
       given<sunder_preset_crack>(notch,
                                  [](World& w, const sunder_preset_crack* c) {
                                    return sunder_scene_add_crack(w.scene, c);
                                  })},
      {"fibres", sizeof(sunder_fibres), 144,
       given<sunder_fibres>(even,
                            [](World& w, const sunder_fibres* f) {
                              return sunder_scene_add_fibres(w.scene, 0, f);
                            })},
      {"fracture_options", sizeof(sunder_fracture_options), 72,
       given<sunder_fracture_options>(tearing,
                                      [](World& w, const sunder_fracture_options* f) {
                                        return sunder_scene_set_fracture(w.scene, f);
                                      })},
      {"solver_options", sizeof(sunder_solver_options), 32,
       given<sunder_solver_options>(on_cpu,
                                    [](World& w, const sunder_solver_options* s) {
                                      return sunder_scene_set_solver(w.scene, s);
                                    })},
      {"callbacks", sizeof(sunder_callbacks), 40,
       given<sunder_callbacks>(silent,
                               [](World& w, const sunder_callbacks* c) {
                                 sunder_simulation made = nullptr;
                                 const auto s = sunder_simulation_create(w.scene, c, &made);
                                 if (made) {
                                   EXPECT_OK(sunder_simulation_destroy(made));
                                 }
                                 return s;
                               })},
  };
}

class COptionStruct : public testing::TestWithParam<Struct> {
 protected:
  sunder_status give(GuardedBytes& bytes) { return GetParam().call(world, bytes.data()); }
  World world;
};

TEST_P(COptionStruct, IsReadAsFarAsTheCallerKnowsIt) {
  for (const std::size_t size : {GetParam().first, GetParam().now}) {
    GuardedBytes bytes(size, static_cast<std::uint32_t>(size));
    EXPECT_OK(give(bytes)) << size;
  }
}

TEST_P(COptionStruct, OfANewerCallerMaySetNothingNew) {
  const std::size_t now = GetParam().now;
  for (const std::size_t size : {now + 8, std::size_t{kLargestOptions}}) {
    GuardedBytes bytes(size, static_cast<std::uint32_t>(size));
    std::memset(bytes.data() + now, 0, size - now);
    EXPECT_OK(give(bytes)) << size;
    bytes.data()[size - 1] = 1;
    EXPECT_EQ(give(bytes), SUNDER_ERROR_STRUCT_SIZE) << size;
  }
}

TEST_P(COptionStruct, IsRefusedUnreadAtASizeOfNoVersion) {
  const auto first = static_cast<std::uint32_t>(GetParam().first);
  for (const std::uint32_t stated : {0u, 1u, first - 1, kLargestOptions + 1, 0xcdcdcdcdu, ~0u}) {
    GuardedBytes bytes(GetParam().now, stated);
    EXPECT_EQ(give(bytes), SUNDER_ERROR_STRUCT_SIZE) << stated;
  }
}

INSTANTIATE_TEST_SUITE_P(All, COptionStruct, testing::ValuesIn(options()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace sunder::test
