// PCL's global registration (KFPCSInitialAlignment, as tests/bench sets it) on pairs of scans: pcl_pairs
// PAIRS OUT
//
// PAIRS: lines "P number delta" (of KFPCS, m), then "A x y" for each landmark of the one scan and "B x y" for
// each of the other, in the frames of their scans. OUT: a line "pair,x_m,y_m,heading_rad,milliseconds" per
// pair, the pose of the second scan in the frame of the first; empty where PCL gives none.
#include "tests/bench/peers.hpp"

#include <chrono>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

using slamsensor::core::Point2;

struct Pair {
  int number = 0;
  float delta_m = 0.0F;
  std::vector<Point2> a;
  std::vector<Point2> b;
};

std::vector<Pair> read_pairs(const std::string& path) {
  std::ifstream file(path);
  std::vector<Pair> pairs;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    char kind = 0;
    double x = 0.0;
    double y = 0.0;
    words >> kind >> x >> y;
    if (kind == 'P') {
      pairs.push_back({static_cast<int>(x), static_cast<float>(y), {}, {}});
    } else if (!pairs.empty()) {
      (kind == 'A' ? pairs.back().a : pairs.back().b).emplace_back(x, y);
    }
  }
  return pairs;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: pcl_pairs PAIRS OUT\n");
    return 64;
  }
  std::FILE* const out = std::fopen(argv[2], "w");
  if (out == nullptr) {
    return 73;
  }
  std::fprintf(out, "pair,x_m,y_m,heading_rad,milliseconds\n");
  for (const Pair& pair : read_pairs(argv[1])) {
    const auto begin = std::chrono::steady_clock::now();
    const auto peer = slamsensor::bench::make_pcl_peer_within(pair.a, pair.delta_m);
    const auto pose = peer->locate(pair.b);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    std::fprintf(out, "%d,", pair.number);
    if (pose) {
      std::fprintf(out, "%.6f,%.6f,%.9f,", pose->x_m, pose->y_m, pose->heading_rad);
    } else {
      std::fprintf(out, ",,,");
    }
    std::fprintf(out, "%.4f\n", took.count());
  }
  return std::fclose(out) == 0 ? 0 : 73;
}
