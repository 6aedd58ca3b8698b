// The lanes of the baseline. That other vector units give the same bits is in vector_unit_test.
#include "core/kernels/lanes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <type_traits>

#include "core/kernels/descend.h"
#include "core/kernels/frontier.h"
#include "core/kernels/lane_vector.h"

namespace organ_collision::core {
namespace {

constexpr std::uint32_t kAll = 0xFF;

template <class Real>
class LanesOf : public testing::Test {
 protected:
  static constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();

  /// Different in every lane, of both signs.
  static Lanes<Real> some() { return Lanes<Real>::numbers() - Lanes<Real>::all(Real{2.5}); }
  static Real some(std::uint32_t lane) { return static_cast<Real>(lane) - Real{2.5}; }
};

struct Names {
  template <class Real>
  static std::string GetName(int /*number*/) {
    return std::is_same_v<Real, float> ? "float" : "double";
  }
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(LanesOf, Reals, Names);

TYPED_TEST(LanesOf, AreLoadedStoredAndReadInOrder) {
  alignas(64) const float values[kLanes] = {3, 1, 4, 1.5F, -9, 2, 6, 5};
  const Lanes<TypeParam> lanes = Lanes<TypeParam>::load(values);
  TypeParam stored[kLanes];
  lanes.store(stored);
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    EXPECT_EQ(lanes[i], TypeParam{values[i]});
    EXPECT_EQ(stored[i], TypeParam{values[i]});
    EXPECT_EQ(Lanes<TypeParam>::all(7)[i], 7);
    EXPECT_EQ(Lanes<TypeParam>::numbers()[i], static_cast<TypeParam>(i));
  }
}

TYPED_TEST(LanesOf, AreCalculatedOneByOne) {
  const Lanes<TypeParam> x = this->some();
  const Lanes<TypeParam> y = Lanes<TypeParam>::numbers() * Lanes<TypeParam>::all(3);
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const TypeParam a = this->some(i);
    const auto b = static_cast<TypeParam>(3 * i);
    EXPECT_EQ((x + y)[i], a + b);
    EXPECT_EQ((x - y)[i], a - b);
    EXPECT_EQ((x * y)[i], a * b);
    EXPECT_EQ((y / x)[i], b / a);
    EXPECT_EQ(root(y)[i], std::sqrt(b));
    EXPECT_EQ(magnitudeOf(x)[i], std::abs(a));
    EXPECT_EQ(larger(x, y)[i], std::max(a, b));
    EXPECT_EQ(smaller(x, y)[i], std::min(a, b));
  }
  EXPECT_EQ(leastOf(x), TypeParam{-2.5});
  EXPECT_EQ(leastOf(Lanes<TypeParam>{} - x), TypeParam{-4.5});
  EXPECT_EQ(mostOf(x), TypeParam{4.5});
  EXPECT_EQ(sumOf(x), TypeParam{8});
}

TEST(Lanes, HoldTheLargestOfEachRow) {
  Lanes<float> rows[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    alignas(64) float values[kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
      values[lane] = static_cast<float>(10 * i + (3 * lane + i) % kLanes);
    rows[i] = Lanes<float>::load(values);
  }
  for (std::uint32_t i = 0; i < kLanes; ++i) EXPECT_EQ(mostOfEach(rows)[i], mostOf(rows[i]));
}

TYPED_TEST(LanesOf, AreMadeOneByOne) {
  const auto lanes =
      Lanes<TypeParam>::each([](int i) { return static_cast<TypeParam>(7 - 2 * i); });
  for (std::uint32_t i = 0; i < kLanes; ++i) EXPECT_EQ(lanes[i], 7 - 2 * static_cast<int>(i));
}

TEST(Lanes, AreGatheredFromAnywhere) {
  VertexPlace places[kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const auto x = static_cast<float>(3 * i);
    places[i] = {x, x + 1, x + 2};
  }
  const auto number = [](std::uint32_t lane) { return 5 * lane % kLanes; };
  std::array<std::uint16_t, kLanes> offsets;
  for (std::uint32_t lane = 0; lane < kLanes; ++lane)
    offsets[lane] = static_cast<std::uint16_t>(number(lane) * sizeof(VertexPlace));
  const LaneVector<float> gathered = gather(&places[0].x, offsets);
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    EXPECT_EQ(gathered.x[lane], 3 * number(lane));
    EXPECT_EQ(gathered.y[lane], 3 * number(lane) + 1);
    EXPECT_EQ(gathered.z[lane], 3 * number(lane) + 2);
  }
}

TYPED_TEST(LanesOf, GiveTheSecondWhereTheFirstIsNotANumber) {
  const Lanes<TypeParam> nan = Lanes<TypeParam>::all(this->kNaN);
  EXPECT_EQ(larger(nan, this->some())[1], this->some(1));
  EXPECT_EQ(smaller(nan, this->some())[1], this->some(1));
}

TYPED_TEST(LanesOf, AreComparedOneByOne) {
  const Lanes<TypeParam> x = this->some();
  const Truth<TypeParam> negative = x <= Lanes<TypeParam>{};
  EXPECT_EQ(negative.bits(), 0b00000111U);
  EXPECT_EQ((!negative).bits(), 0b11111000U);
  EXPECT_EQ((negative & (Lanes<TypeParam>::all(TypeParam{-1.5}) <= x)).bits(), 0b00000110U);
  EXPECT_EQ((x <= x).bits(), kAll);
  EXPECT_EQ((Lanes<TypeParam>::all(this->kNaN) <= x).bits(), 0U);
  const Lanes<TypeParam> chosen = select(negative, Lanes<TypeParam>::all(1), x);
  for (std::uint32_t i = 0; i < kLanes; ++i)
    EXPECT_EQ(chosen[i], i < 3 ? TypeParam{1} : this->some(i));
}

TEST(Lanes, AreNamedByTheirNumbers) {
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) EXPECT_EQ(only(lane).bits(), 1U << lane);
}

TEST(Lanes, AreNamedByBits) {
  for (std::uint32_t bits = 0; bits <= kAll; ++bits) EXPECT_EQ(lanesOf(bits).bits(), bits);
}

TEST(Lanes, AreChosenByTheirNumbers) {
  const Lanes<float> lanes = Lanes<float>::numbers() - Lanes<float>::all(2.5F);
  constexpr std::uint32_t kNumbers = 05742013U;  // in octal, the first one last
  const std::uint32_t expected[kLanes] = {3, 1, 0, 2, 4, 7, 5, 0};
  const Lanes<float> chosen = permuted(lanes, kNumbers);
  for (std::uint32_t i = 0; i < kLanes; ++i) EXPECT_EQ(chosen[i], lanes[expected[i]]);
  EXPECT_EQ(signsOf(lanes), 0b111U);
  EXPECT_EQ(signsOf(Lanes<float>{} - Lanes<float>::numbers()), kAll ^ 1U);
}

TEST(Descent, FindsTheFirstByteThatIsZero) {
  EXPECT_EQ(firstZero(0), 0U);
  EXPECT_EQ(firstZero(0xFF80017F00000100U), 0U);
  EXPECT_EQ(firstZero(0xFF80017F00010101U), 3U);
  EXPECT_EQ(firstZero(0x00FF0180017F8001U), 7U);
}

/// Room for some sets, and lanes that are 0, 1, 4, ... 49 away, squared.
class SetsThatWait : public ::testing::Test {
 protected:
  static constexpr std::size_t kRoom = 40;

  static WideNode nodeOf(std::uint32_t first_node, std::uint32_t node_count,
                         std::uint32_t first_packet) {
    WideNode node = {};
    node.first_node = first_node;
    node.first_packet = first_packet;
    node.node_count = static_cast<std::uint8_t>(node_count);
    node.lane_count = kLaneCount;
    return node;
  }

  std::array<std::uint32_t, kRoom> nodes_, packets_;
  std::array<float, kRoom> bounds_;
  Frontier frontier_{{nullptr, nodes_.data(), packets_.data(), bounds_.data()}};
  const Lanes<float> squares_ = Lanes<float>::numbers() * Lanes<float>::numbers();
};

TEST_F(SetsThatWait, AreThoseOfTheLanesThatAreAdded) {
  for (std::uint32_t pattern = 0; pattern <= kAll; ++pattern) {
    SCOPED_TRACE(pattern);
    Frontier frontier = frontier_;
    frontier.add(nodeOf(100, 3, 200), pattern, squares_);
    std::uint32_t node = 0, packets = 0;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
      if ((pattern >> lane & 1U) == 0) continue;
      if (lane < 3) {
        ASSERT_LT(node, frontier.nodeCount());
        EXPECT_EQ(frontier.node(node++), 100 + lane);
      } else {
        ASSERT_LT(packets, frontier.packetCount());
        EXPECT_EQ(frontier.packet(packets++), 200 + lane - 3);
      }
    }
    EXPECT_EQ(frontier.nodeCount(), node);
    EXPECT_EQ(frontier.packetCount(), packets);
  }
}

TEST_F(SetsThatWait, AreInTheLanesThatTheyAreFoundIn) {
  const WideNode node = nodeOf(100, 3, 200);
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane)
    EXPECT_EQ(laneOf(node, setIn(node, lane)), lane);
}

TEST_F(SetsThatWait, FollowThoseOfNodesBefore) {
  frontier_.addNode(7);
  frontier_.add(nodeOf(100, 8, 0), 0b10000001U, squares_);
  frontier_.add(nodeOf(300, 1, 200), 0b00000011U, squares_);
  ASSERT_EQ(frontier_.nodeCount(), 4U);
  EXPECT_EQ(frontier_.node(0), 7U);
  EXPECT_EQ(frontier_.node(1), 100U);
  EXPECT_EQ(frontier_.node(2), 107U);
  EXPECT_EQ(frontier_.node(3), 300U);
  ASSERT_EQ(frontier_.packetCount(), 1U);
  EXPECT_EQ(frontier_.packet(0), 200U);
}

TEST_F(SetsThatWait, AreTakenTheNearestFirstAndDroppedWhereTheyAreTooFar) {
  const Lanes<float> others = Lanes<float>::all(30) - squares_;  // 30, 29, 26, 21, 14, 5
  frontier_.add(nodeOf(0, 0, 100), 0b11111000U, squares_);
  frontier_.add(nodeOf(0, 0, 200), 0b00111111U, others);
  EXPECT_EQ(frontier_.takeNearestPacket(), 205U);
  EXPECT_EQ(frontier_.takeNearestPacket(), 103U);
  EXPECT_EQ(frontier_.packetCount(), 9U);
  EXPECT_EQ(frontier_.dropPacketsBeyond(25.0F), 26.0F);
  std::set<std::uint32_t> left;
  for (std::uint32_t i = 0; i < frontier_.packetCount(); ++i) left.insert(frontier_.packet(i));
  EXPECT_EQ(left, std::set<std::uint32_t>({104, 105, 203, 204}));
  EXPECT_EQ(frontier_.dropPacketsBeyond(25.0F), kFloatInfinity);
  EXPECT_EQ(frontier_.dropPacketsBeyond(-1.0F), 14.0F);
  EXPECT_EQ(frontier_.packetCount(), 0U);
}

TEST(LeastLane, IsOneOfThoseInUse) {
  const Lanes<float> falling = Lanes<float>::all(7) - Lanes<float>::numbers();
  for (std::uint32_t count = 1; count <= kLaneCount; ++count)
    EXPECT_EQ(laneOfLeast(falling, count), count - 1);
  EXPECT_EQ(laneOfLeast(Lanes<float>::numbers(), kLaneCount), 0U);
  EXPECT_EQ(laneOfLeast(Lanes<float>::all(kFloatInfinity), 3), 0U);
}

TEST(LowerBounds, AreNoLargerInSinglePrecision) {
  const Lanes<double> bounds = Lanes<double>::numbers() * Lanes<double>::all(0.1);
  const Lanes<float> lower = inFloats(bounds);
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    EXPECT_LE(double{lower[lane]}, bounds[lane]);
    EXPECT_NEAR(double{lower[lane]}, bounds[lane], 0x1p-20);
  }
}

}  // namespace
}  // namespace organ_collision::core
