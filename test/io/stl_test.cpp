#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <limits>
#include <string>

#include "mesh_writers.h"

namespace organ_collision::io {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Stl : public MeshIo {};

const Shape kTwoTriangles = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 3, 1}}};

TEST_F(Stl, RefusesNumbersOfStlThatAreNoNumbers) {
  Shape shape = awkwardShape();
  shape.positions[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at (1, nan, 0)"));
  shape.positions[2].y() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal("m.stl", binaryStl(shape)), HasSubstr("vertex 2 is at (1, inf, 0)"));
}

TEST_F(Stl, RefusesAsciiStlThatIsNotWordForWordAsTheFormatWantsIt) {
  const std::string good = asciiStl(kTwoTriangles);
  const auto with = [&](const std::string& from, const std::string& to) {
    return refusal("m.stl", replaced(good, from, to));
  };
  EXPECT_EQ(with("solid organ", "solid"), "");
  EXPECT_EQ(with("solid organ", "\tsolid facet of an organ"), "");
  EXPECT_EQ(with("normal 0 0 0\nouter", "normal nan 1 0 outer"), "");
  EXPECT_EQ(refusal("m.stl", good + "\n" + good), "");
  EXPECT_THAT(
      with("vertex 0 1 0\n", "vertex 0 1 0\nvertex 7 7 0\n"),
      AllOf(HasSubstr("m.stl'"), HasSubstr("line 7: the word endloop is wanted, not 'vertex'")));
  EXPECT_THAT(with("vertex 0 1 0\n", ""), HasSubstr("line 6: the word vertex is wanted"));
  EXPECT_THAT(with("vertex 0 1 0", "vertx 0 1 0"), HasSubstr("line 6: the word vertex is wanted"));
  EXPECT_THAT(with("vertex 0 1 0", "vertex 0 1"), HasSubstr("line 7: 'endloop' is not a number"));
  EXPECT_THAT(with("vertex 0 1 0", "vertex 0 inf 0"),
              HasSubstr("line 6: vertex 2 is at (0, inf, 0)"));
  EXPECT_THAT(with("vertex 0 1 0", "vertex 0 1,5 0"), HasSubstr("line 6: '1,5' is not a number"));
  EXPECT_THAT(with("endfacet\n", "endfacet\nhello world\n"),
              HasSubstr("line 9: the word endsolid is wanted"));
  EXPECT_THAT(with("outer loop\n", ""), HasSubstr("line 3: the word outer is wanted"));
  EXPECT_THAT(with("endsolid organ\n", ""), HasSubstr("ends here, but endsolid is wanted"));
  EXPECT_THAT(with("endfacet\n", "endfacet\nendsolid\n"),
              HasSubstr("line 10: the word solid is wanted"));
}

TEST_F(Stl, ReadsKeywordsInCapitals) {
  std::string text = asciiStl(kTwoTriangles);
  for (char& letter : text) letter = static_cast<char>(std::toupper(letter));
  EXPECT_EQ(load("m.stl", text).triangleCount(), 2U);
}

TEST_F(Stl, TellsHowLongABinaryFileThatBeginsAsAsciiDoesShouldBe) {
  std::string bytes = binaryStl(kTwoTriangles).replace(0, 80, "solid" + std::string(75, ' '));
  EXPECT_EQ(load("m.stl", bytes).triangleCount(), 2U);
  bytes.pop_back();
  EXPECT_THAT(refusal("m.stl", bytes), HasSubstr("it has 183 bytes, but 184 are wanted for 2"));
}

TEST_F(Stl, ReadsBinaryStlThatBeginsAsAsciiDoes) {
  EXPECT_EQ(load("m.stl", binaryStl(kTwoTriangles).replace(0, 5, "solid")).triangleCount(), 2U);
}

TEST_F(Stl, MergesZeroAndMinusZero) {
  Shape shape = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}}, {{0, 1, 2}, {3, 2, 1}}};
  EXPECT_EQ(load("m.stl", binaryStl(shape)).positions().size(), 3u);
}

TEST_F(Stl, RoundsTheDecimalsOfTextCorrectly) {
  const std::string text = replaced(asciiStl(kTwoTriangles), "vertex 0 1 0",
                                    "vertex 0.1 99999999999999999999 1.00000001e-5");
  EXPECT_EQ(load("m.stl", text).positions()[2], Eigen::Vector3d(0.1, 1e20, 1.00000001e-5));
}

TEST_F(Stl, PassesOverTheNamesOfSolids) {
  for (const char* const name : {"part vertex 1 2 3", "thing endsolid x", "solid"})
    EXPECT_EQ(load("m.stl",
                   replaced(asciiStl(kTwoTriangles), "solid organ", std::string("solid ") + name))
                  .triangleCount(),
              2U);
}

TEST_F(Stl, RefusesWhatIsNeitherTextNorAsLongAsABinaryFile) {
  const std::string good = binaryStl(kTwoTriangles);
  for (const std::string& bad : {good.substr(0, good.size() - 1), good + '\0',
                                 std::string("vertex 0 0 0\n"), std::string("\n")})
    EXPECT_THAT(refusal("m.stl", bad), HasSubstr("m.stl': it is neither text, which begins with"));
}

}  // namespace
}  // namespace organ_collision::io
