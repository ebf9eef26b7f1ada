// SPDX-License-Identifier: Apache-2.0
// A host that draws on a queue of another family than the one that it lends: on a device of three
// families (tests/gpu/layer), which keeps account of what each may touch.
#include <cstdlib>
#include <functional>

#include "api/c_scene.hpp"
#include "api/vulkan_host.hpp"
#include "gpu/run_again.hpp"

namespace sunder::test {
namespace {

constexpr VkBufferUsageFlags kUsage =
    VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT;

class OtherFamily : public testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("SUNDER_EXPECT_NO_VULKAN")) {
      GTEST_SKIP() << "no Vulkan device is expected";
    }
  }
};

/// A board on the lent queue, shown on the other.
class Shown {
 public:
  explicit Shown(bool lends) : host({.draws_elsewhere = true}) {
    sunder_vulkan_host lent = host.lend();
    const VkDeviceSize sizes[] = {16 * kBoardNodes, 8 * kBoardTets, 4 * kBoardTets};
    sunder_vulkan_buffer* const parts[] = {&lent.displacement, &lent.stress, &lent.live};
    for (std::size_t i = 0; lends && i < 3; ++i) {
      memory_.push_back(host.allocate(sizes[i], kUsage, true));
      *parts[i] = {reinterpret_cast<std::uint64_t>(memory_[i].buffer), 0, sizes[i]};
    }
    const sunder_scene scene = board_scene(SUNDER_BACKEND_VULKAN);
    EXPECT_OK(sunder_vulkan_create(scene, &lent, nullptr, &simulation));
    EXPECT_OK(sunder_scene_destroy(scene));
    EXPECT_OK(sunder_vulkan_get_display(simulation, &display));
  }
  ~Shown() {
    EXPECT_OK(sunder_simulation_destroy(simulation));
    for (const auto& memory : memory_) host.free(memory);
  }
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

  void record(VkCommandBuffer commands) const {
    EXPECT_OK(sunder_vulkan_record(simulation, commands));
  }
  /// What the other queue reads of the picture is the displacement.
  void expect_shown() const {
    std::vector<double> u(3 * kBoardNodes);
    EXPECT_OK(sunder_simulation_displacement(simulation, u.data(), u.size()));
    const std::vector<std::byte> bytes = host.read(display.displacement);
    std::vector<float> shown(4 * kBoardNodes);
    ASSERT_EQ(bytes.size(), shown.size() * sizeof(float));
    std::memcpy(shown.data(), bytes.data(), bytes.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
      ASSERT_EQ(shown[4 * (i / 3) + i % 3], static_cast<float>(u[i])) << i;
    }
  }
  /// The library's own buffers from one family to another: the same barrier in commands of both.
  void hand_over(VkCommandBuffer commands, std::uint32_t from, std::uint32_t to) const {
    std::vector<VkBufferMemoryBarrier> list;
    for (const auto& part : {display.displacement, display.stress, display.live}) {
      VkBufferMemoryBarrier barrier{};
      barrier.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER;
      barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
      barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT;
      barrier.srcQueueFamilyIndex = from;
      barrier.dstQueueFamilyIndex = to;
      barrier.buffer = reinterpret_cast<VkBuffer>(part.buffer);
      barrier.offset = part.offset;
      barrier.size = part.size;
      list.push_back(barrier);
    }
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr,
                         static_cast<std::uint32_t>(list.size()), list.data(), 0, nullptr);
  }
  void hand_over(std::uint32_t from, std::uint32_t to) const {
    const auto over = [&](VkCommandBuffer commands) { hand_over(commands, from, to); };
    if (from == host.family) host.run(over);
    host.draw(over);
    if (to == host.family) host.run(over);
  }

  VulkanHost host;
  sunder_simulation simulation = nullptr;
  sunder_vulkan_display display = SUNDER_VULKAN_DISPLAY_INIT;

 private:
  std::vector<VulkanHost::Memory> memory_;
};

// Each of these runs in a process of its own, on the device of three families.
TEST_F(OtherFamily, DISABLED_LendsWhatBothShare) {
  const Shown shown(true);
  for (int i = 0; i < 3; ++i) {
    EXPECT_OK(sunder_simulation_step(shown.simulation, nullptr));
    shown.host.run([&](VkCommandBuffer commands) { shown.record(commands); });
    shown.expect_shown();
  }
}

TEST_F(OtherFamily, DISABLED_HandsOverWhatIsTheLibrarys) {
  const Shown shown(false);
  for (int i = 0; i < 3; ++i) {
    EXPECT_OK(sunder_simulation_step(shown.simulation, nullptr));
    shown.host.run([&](VkCommandBuffer commands) { shown.record(commands); });
    shown.hand_over(shown.host.family, shown.host.drawing_family);
    shown.expect_shown();
    shown.hand_over(shown.host.drawing_family, shown.host.family);
  }
}

TEST_F(OtherFamily, DISABLED_TakesWhatIsTheLibrarys) {
  const Shown shown(false);
  EXPECT_OK(sunder_simulation_step(shown.simulation, nullptr));
  shown.host.run([&](VkCommandBuffer commands) { shown.record(commands); });
  shown.expect_shown();
}

std::pair<std::string, int> of_three_families(const std::string& test) {
  return run_again("SUNDER_TEST_LAYER=families", "OtherFamily.DISABLED_" + test);
}

TEST_F(OtherFamily, DrawsWhatBothShare) {
  const auto [output, code] = of_three_families("LendsWhatBothShare");
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("queues of queue family 0 were asked for"), std::string::npos) << output;
}

TEST_F(OtherFamily, DrawsWhatIsHandedOver) {
  const auto [output, code] = of_three_families("HandsOverWhatIsTheLibrarys");
  EXPECT_EQ(code, 0) << output;
}

// That the two above could fail.
TEST_F(OtherFamily, MayNotTouchWhatTheLibraryKeeps) {
  const auto [output, code] = of_three_families("TakesWhatIsTheLibrarys");
  EXPECT_NE(code, 0);
  EXPECT_NE(output.find("a buffer of queue family 2 is used by queue family 0"), std::string::npos)
      << output;
}

}  // namespace
}  // namespace sunder::test
