// compare_opencv [SIDE [REPEATS [KIND...]]]: box, Gaussian and median, or those named, by Fettle and by OpenCV, each on one thread and in the same run, in
// alternation with a plain copy. Rates in million samples per second of processor time, medians of the repeats; ratios are
// medians of the repeats' own. Fettle's rate is all of applyFilter: new tiles, their bounds and the report. OpenCV writes into
// an array that it has written before. Exit status 1 when a result differs from OpenCV's, away from the borders, by more than
// what OpenCV's sums in float may lose.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "engine/field/builder.h"
#include "engine/filter/filter.h"

namespace {

using namespace fettle::engine;

struct Row {
  FilterKind kind;
  const char* name;
  int window;
  double asked;  // times OpenCV's rate; 0: OpenCV has none for floats
};

constexpr Row kRows[] = {
    {FilterKind::kBox, "box", 3, 2.0},           {FilterKind::kBox, "box", 5, 2.0},
    {FilterKind::kBox, "box", 11, 2.0},          {FilterKind::kBox, "box", 31, 2.0},
    {FilterKind::kBox, "box", 101, 2.0},         {FilterKind::kGaussian, "Gaussian", 3, 1.0},
    {FilterKind::kGaussian, "Gaussian", 5, 1.0}, {FilterKind::kGaussian, "Gaussian", 11, 1.5},
    {FilterKind::kGaussian, "Gaussian", 31, 2},  {FilterKind::kGaussian, "Gaussian", 101, 10.0},
    {FilterKind::kMedian, "median", 3, 1.25},    {FilterKind::kMedian, "median", 5, 5.0},
    {FilterKind::kMedian, "median", 11, 0.0},    {FilterKind::kMedian, "median", 31, 0.0},
    {FilterKind::kMedian, "median", 101, 0.0},
};

// Relief with noise.
std::vector<float> reliefOf(int side) {
  std::vector<float> z(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  std::uint64_t state = 7;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      const double noise = static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
      z[static_cast<std::size_t>(r) * static_cast<std::size_t>(side) + static_cast<std::size_t>(c)] =
          static_cast<float>(2.0 * std::cos(r * 0.011) * std::sin(c * 0.013) + 0.3 * noise);
    }
  return z;
}

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

double secondsOf(const std::function<void()>& work) {
  const double begin = processorSeconds();
  work();
  return processorSeconds() - begin;
}

double medianOf(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

void filterByPeer(const Row& row, const cv::Mat& from, cv::Mat& to) {
  const cv::Size size(row.window, row.window);
  if (row.kind == FilterKind::kBox) cv::boxFilter(from, to, -1, size);
  // Of the standard deviation that binomial weights have.
  if (row.kind == FilterKind::kGaussian) cv::GaussianBlur(from, to, size, std::sqrt((row.window - 1) / 4.0));
  if (row.kind == FilterKind::kMedian) cv::medianBlur(from, to, row.window);
}

FilterSpec specOf(const Row& row) {
  FilterSpec spec;
  spec.kind = row.kind;
  spec.window = row.window;
  spec.sigma = row.kind == FilterKind::kGaussian ? std::sqrt((row.window - 1) / 4.0) : 0.0;
  spec.threads = 1;
  return spec;
}

// Largest difference of samples whose windows lie inside.
double mostOff(const Row& row, const Version& ours, const cv::Mat& theirs) {
  const int r = row.window / 2;
  double most = 0.0;
  for (int y = r; y < theirs.rows - r; ++y)
    for (int x = r; x < theirs.cols - r; ++x)
      most = std::max(most, std::fabs(1.0 * ours.reader().heightAt(x, y) - theirs.at<float>(y, x)));
  return most;
}

}  // namespace

int main(int argc, char** argv) {
  const int side = argc > 1 ? std::atoi(argv[1]) : 8192;
  const int repeats = argc > 2 ? std::atoi(argv[2]) : 5;
  if (side < 512 || side > 32768 || repeats < 1) {
    std::fprintf(stderr, "compare_opencv: a side of 512 to 32768 and at least one repeat\n");
    return 2;
  }
  cv::setNumThreads(1);
  const std::vector<float> z = reliefOf(side);
  Grid grid;
  grid.width = grid.height = side;
  const Version field = makeField(grid, z, {});
  const cv::Mat from(side, side, CV_32F, const_cast<float*>(z.data()));
  cv::Mat to(side, side, CV_32F);
  std::vector<float> copied(z.size());
  const double samples = static_cast<double>(z.size());
  bool agree = true;
  fmt::print("OpenCV {}, {} x {} samples, one thread, million samples per second of processor time\n\n",
             CV_VERSION, side, side);
  fmt::print(
      "| filter | window | Fettle | OpenCV | times | asked | copying | of copying "
      "|\n|---|---|---|---|---|---|---|---|\n");
  const std::vector<std::string> kinds(argv + std::min(argc, 3), argv + argc);
  for (const std::string& kind : kinds)
    if (std::ranges::none_of(kRows, [&](const Row& row) { return kind == row.name; })) {
      std::fprintf(stderr, "compare_opencv: no kind %s: box, Gaussian or median\n", kind.c_str());
      return 2;
    }
  for (const Row& row : kRows) {
    if (!kinds.empty() && std::ranges::find(kinds, row.name) == kinds.end()) continue;
    std::vector<double> ours, theirs, ratio, copy;
    double off = 0.0;
    for (int i = -1; i < repeats; ++i) {
      JobControl job;
      Result<Filtered> result;
      // Large medians have a part of the field's time.
      const double a = secondsOf([&] { result = applyFilter(field, field, specOf(row), job); });
      if (!result) {
        std::fprintf(stderr, "%s\n", result.error().line().c_str());
        return 2;
      }
      const double b = row.asked > 0.0 ? secondsOf([&] { filterByPeer(row, from, to); }) : 0.0;
      const double c = secondsOf([&] { std::memcpy(copied.data(), z.data(), z.size() * sizeof(float)); });
      if (i < 0) {  // obtains the memory
        if (row.asked > 0.0) off = mostOff(row, result->field, to);
        continue;
      }
      ours.push_back(samples / a * 1e-6);
      copy.push_back(samples / c * 1e-6);
      if (row.asked > 0.0) {
        theirs.push_back(samples / b * 1e-6);
        ratio.push_back(b / a);
      }
    }
    const bool differs = off > 1e-5;
    agree = agree && !differs;
    const auto or_dash = [&](const std::string& text) { return row.asked > 0.0 ? text : std::string("-"); };
    fmt::print("| {} | {} | {:.0f} | {} | {} | {} | {:.0f} | {:.2f} |{}\n", row.name, row.window,
               medianOf(ours), or_dash(row.asked > 0.0 ? fmt::format("{:.0f}", medianOf(theirs)) : ""),
               or_dash(row.asked > 0.0 ? fmt::format("{:.2f}", medianOf(ratio)) : ""),
               or_dash(fmt::format("{:g}", row.asked)), medianOf(copy), medianOf(ours) / medianOf(copy),
               differs ? fmt::format(" DIFFERS by {:g}", off) : "");
    std::fflush(stdout);
  }
  return agree ? 0 : 1;
}
