// The report: curves, who is ahead, and a page that shows everything as it is.
#include "lab/evaluate/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lab/evaluate/curve.hpp"
#include "lab/evaluate/results.hpp"
#include "lab/evaluate/svg_plot.hpp"
#include "lab/evaluate/sweep_picture.hpp"

namespace sweepcast::lab {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

EvaluationRow row(std::string codec, std::string setting, double ratio, Figures figures) {
  EvaluationRow result{std::move(codec), std::move(setting), {}, std::move(figures)};
  result.coding.ratio = ratio;
  result.coding.bytes = 16e5 / ratio;
  return result;
}

TEST(BestAt, IsOnTheLineOverTheLogarithmOfRatios) {
  const Curve curve{"x", {{10, 100, ""}, {100, 80, ""}, {1000, 20, ""}}};
  EXPECT_NEAR(*best_at(curve, 10, true), 100.0, 1e-9);
  EXPECT_NEAR(*best_at(curve, std::sqrt(10.0) * 10.0, true), 90.0, 1e-9);
  EXPECT_NEAR(*best_at(curve, 100 * std::sqrt(10.0), true), 50.0, 1e-9);
  EXPECT_NEAR(*best_at(curve, 1, true), 100.0, 1e-9) << "a larger ratio does as well";
  EXPECT_FALSE(best_at(curve, 1001, true));
}

TEST(BestAt, TakesWhatALargerRatioGivesBetter) {
  const Curve curve{"x", {{10, 0.3, ""}, {100, 0.2, ""}}};
  EXPECT_DOUBLE_EQ(*best_at(curve, 10, false), 0.2);
  EXPECT_DOUBLE_EQ(*best_at(curve, 10, true), 0.3);
}

TEST(Standings, CompareBeamWithTheBestOfTheOthers) {
  const std::vector<EvaluationRow> rows{
      row("original", "", 1, {{"mesh_f10", 100}, {"translation_error_percent", 0.2}}),
      row("beam", "a", 31, {{"mesh_f10", 97}, {"translation_error_percent", 0.25}}),
      row("beam", "b", 300, {{"mesh_f10", 60}, {"translation_error_percent", kNone}}),
      row("low", "a", 30, {{"mesh_f10", 90}, {"translation_error_percent", 0.3}}),
      row("low", "b", 120, {{"mesh_f10", 50}, {"translation_error_percent", 0.4}}),
      row("high", "a", 30, {{"mesh_f10", 98}, {"translation_error_percent", 0.24}}),
      row("high", "b", 40, {{"mesh_f10", 10}, {"translation_error_percent", 0.9}})};
  const auto standings = standings_of(rows);
  ASSERT_EQ(standings.size(), 1U + 5U);  // beam's errors reach 31, its F-scores 300
  EXPECT_EQ(standings[0].metric->figure, "translation_error_percent");
  EXPECT_FALSE(standings[0].is_ahead()) << "0.25 % is more than 0.24 %";
  EXPECT_EQ(standings[1].rival, "high");
  EXPECT_FALSE(standings[1].is_ahead()) << "97 < 98 at 30";
  EXPECT_DOUBLE_EQ(standings[1].theirs, 98.0);
  EXPECT_EQ(standings[2].rival, "low");
  EXPECT_NEAR(standings[2].theirs, 70.0, 1e-9) << "60 is halfway from 30 to 120";
  EXPECT_TRUE(standings[2].is_ahead());
  EXPECT_EQ(standings[5].rival, "") << "nobody else reaches 300";
  EXPECT_TRUE(standings[5].is_ahead());
}

TEST(Results, HaveTheContractsKeys) {
  const std::vector<EvaluationRow> rows{row(
      "a\"b", "x,y", 50, {{"f_score.0.05", 70.5}, {"f_score.0.10", 90}, {"d1_psnr", INFINITY}})};
  const auto json = nlohmann::json::parse(results_json(rows).dump());
  ASSERT_EQ(json.size(), 1U);
  EXPECT_EQ(json[0]["codec"], "a\"b");
  EXPECT_DOUBLE_EQ(json[0]["ratio"], 50.0);
  EXPECT_DOUBLE_EQ(json[0]["f_score"]["0.05"], 70.5);
  EXPECT_DOUBLE_EQ(json[0]["f_score"]["0.10"], 90.0);
  for (const char* key : {"d1_psnr", "d2_psnr", "mesh_f10", "mesh_f10_truth", "bev_ap50",
                          "bev_ap70", "translation_error_percent"}) {
    ASSERT_TRUE(json[0].contains(key)) << key;
    EXPECT_TRUE(json[0][key].is_null()) << key;
  }
  EXPECT_TRUE(json[0]["encode_ms"].is_number());
  EXPECT_EQ(results_csv(rows),
            "codec,setting,ratio,bytes,encode_ms,decode_ms,f_score.0.05,f_score.0.10,d1_psnr\n"
            "\"a\"\"b\",\"x,y\",50,32000,0,0,70.5,90,\n");
}

TEST(Escaped, LeavesNothingThatAPageWouldObey) {
  EXPECT_EQ(escaped("<b a='1' c=\"2\">&amp;"), "&lt;b a=&#39;1&#39; c=&quot;2&quot;&gt;&amp;amp;");
  EXPECT_EQ(escaped("Stra\xC3\x9F"
                    "e \xE2\x82\xAC \xF0\x9F\x98\x80"),
            "Stra\xC3\x9F"
            "e \xE2\x82\xAC \xF0\x9F\x98\x80");
  const std::string bad = "\xEF\xBF\xBD";
  EXPECT_EQ(escaped(std::string("a\0b\x1F", 4)), "a" + bad + "b" + bad);
  EXPECT_EQ(escaped("\xFF\xC3"), bad + bad);
  EXPECT_EQ(escaped("\xC0\x80"), bad + bad) << "a zero the long way";
  EXPECT_EQ(escaped("\xED\xA0\x80"), bad + bad + bad) << "half a pair of UTF-16";
}

TEST(Page, ShowsTextFromOutsideAsText) {
  const std::string evil = "<script>alert(1)</script>\"'><img src=http://x>";
  std::vector<EvaluationRow> rows;
  for (const double ratio : {20.0, 100.0, 400.0}) {
    rows.push_back(row(evil, evil, ratio, {{"mesh_f10", 50}, {"d2_psnr", 60}}));
    rows.back().coding.parts = {{evil, 100.0}};
    rows.push_back(row("beam", evil, ratio, {{"mesh_f10", 60}, {"d2_psnr", 70}}));
    rows.back().coding.parts = {{evil, 100.0}};
  }
  const std::string page = report_page(rows, {evil, 3, evil, {evil}, {evil}});
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("<img src=http"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;alert(1)"), std::string::npos);
  EXPECT_NE(page.find("name=\"viewport\""), std::string::npos);
  EXPECT_NE(page.find("<svg class=\"plot\""), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST(Page, StandsWithoutAnyResult) {
  const std::string page = report_page({}, {"drive", 1, "0", {}, {"mesh: no poses"}});
  EXPECT_NE(page.find("mesh: no poses"), std::string::npos);
  EXPECT_EQ(page.find("<svg class=\"plot\""), std::string::npos);
}

TEST(Base64, IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Ticks, AreRoundAndWithinTheRange) {
  const auto unit = round_ticks(0.0, 1.0);
  ASSERT_EQ(unit.size(), 6U);
  EXPECT_DOUBLE_EQ(unit[1], 0.2);
  const auto ticks = round_ticks(37.0, 100.0);
  ASSERT_EQ(ticks.size(), 4U);
  EXPECT_DOUBLE_EQ(ticks.front(), 40.0);
  EXPECT_DOUBLE_EQ(ticks.back(), 100.0);
  EXPECT_TRUE(round_ticks(1.0, 1.0).empty());
}

}  // namespace
}  // namespace sweepcast::lab
