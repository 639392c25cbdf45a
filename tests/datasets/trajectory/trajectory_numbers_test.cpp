// SPDX-License-Identifier: BSD-3-Clause
// Stamps are exact integers and numbers the nearest doubles, however they are written.
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "datasets/files/numbers.h"
#include "datasets/files/table.h"
#include "datasets/trajectory/formats.h"

namespace plumbline {
namespace {

TEST(ParseStamp, KeepsEveryNanosecondOfSeconds) {
  // As a double, 1403715529.112143517 s would be 1403715529.1121435165...: 0.2 us apart.
  EXPECT_EQ(parseStamp("1403715529.112143517", 9), 1403715529112143517);
  EXPECT_EQ(parseStamp("1.403715529112143517e+09", 9), 1403715529112143517);
  EXPECT_EQ(parseStamp("1403715529112143517E-9", 9), 1403715529112143517);
  EXPECT_EQ(parseStamp("+0.000000001", 9), 1);
  EXPECT_EQ(parseStamp("-0.000000001", 9), -1);
  EXPECT_EQ(parseStamp("5", 9), 5'000'000'000);
  EXPECT_EQ(parseStamp("5.", 9), 5'000'000'000);
  EXPECT_EQ(parseStamp(".5", 9), 500'000'000);
}

TEST(ParseStamp, RoundsWhatLiesBelowANanosecond) {
  EXPECT_EQ(parseStamp("1.0000000004999999999999999999999", 9), 1'000'000'000);
  EXPECT_EQ(parseStamp("1.0000000005", 9), 1'000'000'001);
  EXPECT_EQ(parseStamp("-1.0000000005", 9), -1'000'000'001);
  EXPECT_EQ(parseStamp("1403636579763555584.4999", 0), 1403636579763555584);
  EXPECT_EQ(parseStamp("1403636579763555584.5", 0), 1403636579763555585);
  EXPECT_EQ(parseStamp("1e-30", 9), 0);
}

TEST(ParseStamp, ReadsNanosecondsWithDecimalsAsOrbSlamWritesThem) {
  EXPECT_EQ(parseStamp("1403636579763555584.000000", 0), 1403636579763555584);
  EXPECT_EQ(parseStamp("0001403636579763555584.0000000000", 0), 1403636579763555584);
}

TEST(ParseStamp, KnowsOtherUnitsAndItsRange) {
  EXPECT_EQ(parseStamp("1403636579763.555584", 6), 1403636579763555584);
  EXPECT_EQ(parseStamp("1403636579763555.584", 3), 1403636579763555584);
  EXPECT_EQ(parseStamp("9223372036854775807", 0), std::numeric_limits<TimeNs>::max());
  EXPECT_EQ(parseStamp("9223372036854775808", 0), std::nullopt);
  EXPECT_EQ(parseStamp("1403636579763555584", 9), std::nullopt);
  EXPECT_EQ(parseStamp("1e300", 9), std::nullopt);
  EXPECT_EQ(parseStamp("1e999999999999", 9), std::nullopt);
}

TEST(ParseStamp, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "-", ".", "e5", "1.5s", "nan", "inf", "1 2", "0x10", "1e"}) {
    EXPECT_EQ(parseStamp(text, 9), std::nullopt) << text;
  }
}

void expectNearest(const std::string& text) {
  const std::optional<double> value = parseNumber(text);
  ASSERT_TRUE(value.has_value()) << text;
  EXPECT_EQ(*value, std::strtod(text.c_str(), nullptr)) << text;
}

TEST(ScanNumber, IsTheNearestDoubleInEveryNotation) {
  constexpr std::array kForms = {"{:.{}e}", "{:.{}f}", "{:.{}g}"};
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const double value = uniform(random) * std::pow(10.0, static_cast<int>(random() % 40) - 20);
    const std::string text = fmt::format(fmt::runtime(kForms[random() % 3]), value, random() % 20);
    expectNearest(text);
  }
}

TEST(ScanNumber, CoversTheEdgesOfItsFastPath) {
  for (const char* text :
       {"9007199254740992", "9007199254740993", "9007199254740991e22", "9007199254740991e23",
        "1e-22", "1e-23", "123456789012345678901234567890", "0.1000000000000000055511151231257827",
        "4.9e-324", "1.7976931348623157e308", "-0.0", "00012.50", "1e5", "18446744073709551616"}) {
    expectNearest(text);
  }
  EXPECT_TRUE(std::signbit(*parseNumber("-0.0")));
  EXPECT_EQ(parseNumber("1e-400"), 0.0);
  EXPECT_TRUE(std::isinf(*parseNumber("1e400")));
  EXPECT_TRUE(std::isnan(*parseNumber("nan")));
  for (const char* text : {"", "-", "1.5x", "--1", "one"}) EXPECT_FALSE(parseNumber(text)) << text;
}

TEST(TableHeader, StatesOrderAndUnitOfTheWildVariants) {
  const auto euroc = parseTableHeader(
      "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
      "q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1]");
  ASSERT_TRUE(euroc && euroc->quaternion);
  EXPECT_EQ(*euroc->quaternion, (std::array{5, 6, 7, 4}));
  EXPECT_EQ(euroc->position, 1);
  EXPECT_EQ(euroc->stamp_power, 0);
  const auto blanks = parseTableHeader(
      "#timestamp [ns] p_RS_R_x [m] p_RS_R_y [m] p_RS_R_z [m] "
      "q_RS_w [] q_RS_x [] q_RS_y [] q_RS_z []");
  ASSERT_TRUE(blanks && blanks->quaternion);
  EXPECT_EQ(*blanks->quaternion, (std::array{5, 6, 7, 4}));
  const auto tum = parseTableHeader("# timestamp(s) tx ty tz qx qy qz qw");
  ASSERT_TRUE(tum && tum->quaternion);
  EXPECT_EQ(*tum->quaternion, (std::array{4, 5, 6, 7}));
  EXPECT_EQ(tum->stamp_power, 9);
  const auto short_names = parseTableHeader("#time(ms),px,py,pz,qw,qx,qy,qz,vx,vy,vz");
  ASSERT_TRUE(short_names && short_names->quaternion);
  EXPECT_EQ(*short_names->quaternion, (std::array{5, 6, 7, 4}));
  EXPECT_EQ(short_names->stamp_power, 6);
  EXPECT_EQ(parseTableHeader("# time x y z qx qy qz qw")->stamp_power, std::nullopt);
}

TEST(TableHeader, FindsAQuaternionBeforeThePosition) {
  const auto header = parseTableHeader("timestamp,qx,qy,qz,qw,tx,ty,tz");
  ASSERT_TRUE(header && header->quaternion);
  EXPECT_EQ(*header->quaternion, (std::array{1, 2, 3, 4}));
  EXPECT_EQ(header->position, 5);
}

TEST(TableHeader, IsNoOtherComment) {
  for (const char* line : {"# ground truth trajectory", "# file: 'rgbd_dataset.bag'", "#", "",
                           "# TF Coordinate Frame ID: /openni_rgb_optical_frame(data: /openni)",
                           "# time of the recording was noon"}) {
    EXPECT_FALSE(parseTableHeader(line)) << line;
  }
}

TEST(TextLines, CountsLinesWithoutTheirEnds) {
  TextLines lines(
      "\xEF\xBB\xBF"
      "a b \r\n\n\tc");
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.text(), "a b");
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.text(), "");
  ASSERT_TRUE(lines.next());
  EXPECT_EQ(lines.text(), "c");
  EXPECT_EQ(lines.number(), 3);
  EXPECT_FALSE(lines.ended());
  EXPECT_FALSE(lines.next());
}

TEST(CsvCells, KeepEmptyAndQuotedOnes) {
  const auto cells = csvCells("Take Name,\"a, b\",, 3 ,");
  EXPECT_EQ(cells, (std::vector<std::string_view>{"Take Name", "a, b", "", "3", ""}));
}

}  // namespace
}  // namespace plumbline
