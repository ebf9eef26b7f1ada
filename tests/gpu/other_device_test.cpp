// SPDX-License-Identifier: Apache-2.0
// On devices other than the one at hand, which a layer makes of it (tests/gpu/layer): what stands
// between two barriers runs in another order, queues that compute are not the first family, and a
// device has but a portable subset of Vulkan.
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "gpu_body.hpp"
#include "run_again.hpp"
#include "torn_run.hpp"

namespace sunder::test {
namespace {

using OtherDevice = WithVulkan<>;

constexpr std::size_t kPanel = 5'000'000;  // bytes: of 2,052 unknowns seven panels

/// A run in every way in which kernels depend on each other.
std::vector<Way> ways(gpu::Variant variant) {
  std::vector<Way> list = all_ways();
  std::erase_if(list, [&](const Way& way) { return way.variant != variant; });
  list.push_back({.variant = variant, .update = Update::automatic, .route = Route::cg});
  list.push_back({.variant = variant, .panel_bytes = kPanel, .inverts = true});
  list.push_back({.variant = variant, .update = Update::eager, .panel_bytes = kPanel});
  list.push_back({.variant = variant, .damage = true});
  list.push_back({.variant = variant, .route = Route::condensed, .region = true});
  return list;
}

std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {  // FNV-1a by words
  return (hash ^ word) * 0x100000001b3;
}

std::uint64_t bits_of(const TornRun& torn) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const Index e : torn.destroyed) hash = mixed(hash, static_cast<std::uint64_t>(e));
  for (const Vec3& u : torn.displacement) {
    for (const double x : u) hash = mixed(hash, std::bit_cast<std::uint64_t>(x));
  }
  for (const Voigt& s : torn.stress) {
    for (const double x : s) hash = mixed(hash, std::bit_cast<std::uint64_t>(x));
  }
  return hash;
}

/// What a run of its own process prints: a line a way.
void tell_bits(gpu::Variant variant) {
  for (const Way& way : ways(variant)) {
    const TornRun torn = tear(way);
    EXPECT_FALSE(torn.destroyed.empty());
    std::printf("bits of %s: %016llx\n", name_of(way).c_str(),
                static_cast<unsigned long long>(bits_of(torn)));
  }
}

TEST_F(OtherDevice, DISABLED_TellsTheBitsOfGpu) { tell_bits(gpu::Variant::gpu); }
TEST_F(OtherDevice, DISABLED_TellsTheBitsOfLvp) { tell_bits(gpu::Variant::lvp); }

std::vector<std::string> bits_told_in(const std::string& output) {
  std::vector<std::string> lines;
  std::istringstream text(output);
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("bits of ")) lines.push_back(line);
  }
  return lines;
}

void expect_the_same_bits_backwards(const char* test, std::size_t ways) {
  const auto [usual, usual_code] = run_again("", test);
  EXPECT_EQ(usual_code, 0) << usual;
  const auto [output, code] = run_again("SUNDER_TEST_LAYER=backwards", test);
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("ran in reverse order"), std::string::npos) << output;
  const std::vector<std::string> bits = bits_told_in(usual);
  EXPECT_EQ(bits.size(), ways);
  EXPECT_EQ(bits_told_in(output), bits);
}

TEST_F(OtherDevice, RunsWhatStandsBetweenBarriersInAnyOrderAsAGpu) {
  expect_the_same_bits_backwards("OtherDevice.DISABLED_TellsTheBitsOfGpu",
                                 ways(gpu::Variant::gpu).size());
}

TEST_F(OtherDevice, RunsWhatStandsBetweenBarriersInAnyOrderAsLavapipe) {
  expect_the_same_bits_backwards("OtherDevice.DISABLED_TellsTheBitsOfLvp",
                                 ways(gpu::Variant::lvp).size());
}

TEST_F(OtherDevice, MultipliesAndMakesABaseAnewInAnyOrder) {
  const auto [output, code] = run_again("SUNDER_TEST_LAYER=backwards",
                                        "*Products.*:Inversion.AnUpdateIsTheDamagedBodysInverse");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("ran in reverse order"), std::string::npos) << output;
}

TEST_F(OtherDevice, TakesTheFamilyOfQueuesThatComputes) {
  const auto [output, code] = run_again("SUNDER_TEST_LAYER=families", "VulkanVariant.*");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("queues of queue family 2 were asked for"), std::string::npos) << output;
  EXPECT_EQ(output.find("queues of queue family 0"), std::string::npos) << output;
}

/// A driver's manifest that says that its devices have a portable subset alone: a loader names
/// these to those who ask for them, and to no one else.
std::filesystem::path portable_driver(const std::filesystem::path& folder) {
  for (const auto& entry : std::filesystem::directory_iterator("/usr/share/vulkan/icd.d")) {
    if (entry.path().filename().string().find("lvp") == std::string::npos) continue;
    std::ifstream file(entry.path());
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string before = "\"ICD\": {";
    const std::size_t at = text.find(before);
    if (at == std::string::npos) continue;
    text.insert(at + before.size(), "\n        \"is_portability_driver\": true,");
    std::filesystem::path path = folder / "portable.json";
    std::ofstream(path) << text;
    return path;
  }
  return {};
}

TEST_F(OtherDevice, OfAPortableSubsetIsAskedForByName) {
  std::string name = (std::filesystem::temp_directory_path() / "sunder-driver-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const std::filesystem::path driver = portable_driver(name);
  ASSERT_FALSE(driver.empty()) << "no driver of Mesa's lavapipe in /usr/share/vulkan/icd.d";
  const auto [output, code] =
      run_again("SUNDER_TEST_LAYER=portable VK_DRIVER_FILES=" + driver.string() +
                    " VK_ICD_FILENAMES=" + driver.string(),
                "VulkanVariant.*");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("VK_KHR_portability_subset was asked for"), std::string::npos) << output;
  std::filesystem::remove_all(name);
}

}  // namespace
}  // namespace sunder::test
