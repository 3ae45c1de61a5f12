// spoor-bench craters: how exact the profile is, what records cost beside deformed ground (Cossetin Neto et al.,
// figure 7), the spatial hash up to a million craters, and lazy ground beside eager.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>

#include "shared/base/kernels.h"
#include "shared/base/statistics.h"
#include "shared/world/dormant_ground.h"
#include "shared/world/tile_store.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

int drawn(std::mt19937& engine, int low, int high) {
  return low + int(engine() % (std::uint32_t(high) - std::uint32_t(low) + 1u));
}

// ---- fixed point beside real numbers

/// Algorithm 1 in real numbers, without noise.
double profileOf(const rules::CraterShape& shape, double dx, double dy) {
  const double distance = std::sqrt(dx * dx + dy * dy);
  const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
  if (distance > shape.outer) return 0;
  if (distance < shape.crest) return smooth(distance / shape.crest) * (double(shape.rim) + shape.depth) - shape.depth;
  const double x = shape.outer > shape.crest ? (distance - shape.crest) / (shape.outer - shape.crest) : 0;
  return smooth(std::sqrt(std::max(0.0, 1 - x * x))) * shape.rim;
}

struct Sample {
  rules::CraterShape shape;
  int dx, dy;
};

/// A crater of any size, and a place within its reach.
Sample drawSample(std::mt19937& engine, bool noise) {
  const int crest = 1 + (drawn(engine, 0, rules::kCraterReachLimit / 2 - 1) >> drawn(engine, 0, 21));
  const int inner = drawn(engine, 0, crest);
  const auto height = [&] { return drawn(engine, 0, rules::kCraterHeightLimit) >> drawn(engine, 0, 12); };
  Sample sample{rules::craterShape(0, 0, inner, crest, height(), height(), drawn(engine, 0, 65535),
                                   noise ? drawn(engine, 0, 65535) : 0, 0),
                0, 0};
  const double distance = sample.shape.outer * std::sqrt(drawn(engine, 0, 1 << 20) / double(1 << 20));
  const double angle = drawn(engine, 0, 1 << 20) * 2 * std::numbers::pi / (1 << 20);
  sample.dx = int(std::lround(distance * std::cos(angle)));
  sample.dy = int(std::lround(distance * std::sin(angle)));
  return sample;
}

/// Nanoseconds a cell of whole rows through a crater, by the fastest kernels.
double rowNanoseconds(int noise_q16, Report& report) {
  const auto shape = rules::craterShape(0, 0, 30000, 60000, 5000, 20000, 7, noise_q16, 0);
  constexpr int kStep = 250, kSide = 720;  // cells of 25 mm across all of it
  std::vector<std::int32_t> row(kSide);
  const auto start = Clock::now();
  std::int64_t sum = 0;
  for (int y = 0; y < kSide; ++y) {
    kernels().craterRow(shape, -kStep * kSide / 2, kStep, (y - kSide / 2) * kStep, kSide, row.data());
    for (const std::int32_t change : row) sum += change;
  }
  const double time_ms = millisecondsSince(start);
  std::int64_t expected = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      expected += rules::craterDisplacement(shape, (x - kSide / 2) * kStep, (y - kSide / 2) * kStep);
  if (sum != expected) report.faults.push_back("craters: rows differ from the rule");
  return time_ms * 1e6 / (double(kSide) * kSide);
}

void measureProfile(Report& report) {
  constexpr std::size_t kCount = 1000000;
  std::mt19937 engine(11);
  std::vector<Sample> plain, noisy;
  for (std::size_t i = 0; i < kCount; ++i) {
    plain.push_back(drawSample(engine, false));
    noisy.push_back(drawSample(engine, true));
  }
  std::vector<std::int32_t> fixed(kCount);
  std::vector<double> real(kCount);
  const auto nanoseconds = [&](auto evaluate) {
    const auto start = Clock::now();
    for (std::size_t i = 0; i < kCount; ++i) evaluate(i);
    return millisecondsSince(start) * 1e6 / kCount;
  };
  const double real_ns =
      nanoseconds([&](std::size_t i) { real[i] = profileOf(plain[i].shape, plain[i].dx, plain[i].dy); });
  const double noisy_ns = nanoseconds(
      [&](std::size_t i) { fixed[i] = rules::craterDisplacement(noisy[i].shape, noisy[i].dx, noisy[i].dy); });
  const double fixed_ns = nanoseconds(
      [&](std::size_t i) { fixed[i] = rules::craterDisplacement(plain[i].shape, plain[i].dx, plain[i].dy); });
  double worst = 0, squares = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    worst = std::max(worst, std::abs(fixed[i] - real[i]));
    squares += (fixed[i] - real[i]) * (fixed[i] - real[i]);
  }
  std::printf("profile, %zu samples of craters of any size up to R3 = 838 m, 105 m deep and high\n", kCount);
  std::printf("  largest error %.3f units of 0.1 mm, root of the mean square %.3f (rounding alone: 0.500, 0.289)\n",
              worst, std::sqrt(squares / kCount));
  std::printf("  one processor: double %.0f ns, fixed point %.0f (ratio %.2f), with noise %.0f (%.2f)\n", real_ns,
              fixed_ns, fixed_ns / real_ns, noisy_ns, noisy_ns / real_ns);
  const double row_ns = rowNanoseconds(0, report), noisy_row_ns = rowNanoseconds(10000, report);
  std::printf("  rows of cells (%s): %.0f ns (ratio %.2f), with noise %.0f (%.2f)\n\n", kernels().name, row_ns,
              row_ns / real_ns, noisy_row_ns, noisy_row_ns / real_ns);
  if (worst >= 1) report.faults.push_back("craters: fixed point is off by " + std::to_string(worst) + " units");
}

// ---- scenes

/// A map with room for a disc in its middle.
ScenePack makeField(double disc_m, double cell_m, double hash_cell_m) {
  ScenePack pack;
  pack.name = "craters";
  pack.cell_q = std::int32_t(std::lround(cell_m * rules::kUnitsPerMetre));
  pack.width_cells = pack.height_cells = std::int32_t(std::lround((disc_m + 40) / cell_m));
  pack.soil_depth_q = 20 * rules::kUnitsPerMetre;
  pack.noise = {5, std::int64_t(std::lround(cell_m * 0.02 * 4294967296.0)), 3, 0, 30000};
  pack.crater_limits.hash_cell_q = std::int32_t(std::lround(hash_cell_m * rules::kUnitsPerMetre));
  pack.crater_limits.radius_q = std::min(rules::kCraterReachLimit, pack.crater_limits.hash_cell_q);
  if (Status status = validatePack(pack); !status) throw std::runtime_error(status.error());
  return pack;
}

/// Craters of 5 to 20 m across, thrown into a disc.
std::vector<Crater> throwCraters(const ScenePack& pack, double disc_m, std::size_t count) {
  std::mt19937 engine(23);
  std::vector<Crater> craters(count);
  const double middle_q = 0.5 * pack.width_cells * pack.cell_q;
  for (std::size_t i = 0; i < count; ++i) {
    Crater& crater = craters[i];
    const double distance = disc_m / 2 * std::sqrt(drawn(engine, 0, 1 << 20) / double(1 << 20));
    const double angle = drawn(engine, 0, 1 << 20) * 2 * std::numbers::pi / (1 << 20);
    crater.x_q = std::int32_t(middle_q + distance * std::cos(angle) * rules::kUnitsPerMetre);
    crater.y_q = std::int32_t(middle_q + distance * std::sin(angle) * rules::kUnitsPerMetre);
    const int outer_q = drawn(engine, 25000, 100000);
    crater.crest_radius_q = outer_q * 2 / 3;
    crater.inner_radius_q = 2 * crater.crest_radius_q - outer_q;
    crater.depth_q = outer_q / 5;
    crater.rim_height_q = balancedRimHeight(crater.inner_radius_q, crater.crest_radius_q, crater.depth_q);
    crater.noise_seed = std::uint16_t(engine());
    crater.noise_q16 = 10000;
    crater.tick = 1;
    crater.id = std::uint32_t(i);
  }
  return craters;
}

// ---- volume

/// What a set of craters adds to the map, and digs out of it, 0.1 mm * cells.
struct Volume {
  std::int64_t sum = 0, dug = 0;
};

Volume volumeOf(const ScenePack& pack, const std::vector<Crater>& craters) {
  CraterSet set(pack);
  set.add(craters);
  std::vector<std::int32_t> row(std::size_t(pack.width_cells));
  Volume volume;
  for (std::int32_t y = 0; y < pack.height_cells; ++y) {
    set.fill(0, y, 1, pack.width_cells, 1, row);
    for (const std::int32_t change : row) {
      volume.sum += change;
      volume.dug -= std::min(change, 0);
    }
  }
  return volume;
}

/// What cells, noise and overlap leave over of craters whose profile integrates to zero.
void measureBalance() {
  constexpr double kCell_m = 0.05;
  std::printf("balanced craters on cells of %.2f m: volume left over, percent of what is dug out\n", kCell_m);
  std::printf("  %6s %10s %12s %12s %18s %20s\n", "R3, m", "dug, m3", "no noise", "noise 0.15", "noise 0.5",
              "two, half apart");
  for (const double radius_m : {0.5, 2.5, 10.0, 40.0}) {
    const ScenePack pack = makeField(4 * radius_m, kCell_m, 75);
    Crater crater;
    crater.x_q = crater.y_q = pack.width_cells * pack.cell_q / 2;
    const auto outer_q = std::int32_t(std::lround(radius_m * rules::kUnitsPerMetre));
    crater.crest_radius_q = outer_q * 2 / 3;
    crater.inner_radius_q = 2 * crater.crest_radius_q - outer_q;
    crater.depth_q = outer_q / 4;
    crater.rim_height_q = balancedRimHeight(crater.inner_radius_q, crater.crest_radius_q, crater.depth_q);
    crater.tick = 1;
    const auto percent = [](const Volume& volume) { return 100.0 * double(volume.sum) / double(volume.dug); };
    const Volume plain = volumeOf(pack, {crater});
    std::printf("  %6.1f %10.3f %12.4f", radius_m, double(plain.dug) / rules::kUnitsPerMetre * kCell_m * kCell_m,
                percent(plain));
    for (const double noise : {0.15, 0.5}) {
      // The mean of what eight seeds leave over, by size: its sign is chance.
      double left = 0;
      for (std::uint16_t seed = 0; seed < 8; ++seed) {
        Crater rough = crater;
        rough.noise_seed = seed;
        rough.noise_q16 = std::uint16_t(noise * 65536);
        left += std::abs(percent(volumeOf(pack, {rough}))) / 8;
      }
      std::printf(" %15.2f", left);
    }
    Crater beside = crater;
    beside.x_q += crater.crest_radius_q;
    beside.id = 1;
    std::printf(" %20.2f\n", percent(volumeOf(pack, {crater, beside})));
  }
  std::printf("\n");
}

// ---- figure 7

/// Blocks of 128 x 128 samples 1 m apart that the craters touch: what deformation textures would have to hold.
std::size_t touchedBlocks(const std::vector<Crater>& craters) {
  constexpr std::int64_t kBlock_q = 128 * rules::kUnitsPerMetre;
  std::set<std::pair<std::int64_t, std::int64_t>> blocks;
  for (const Crater& crater : craters)
    for (std::int64_t y = (crater.y_q - crater.outerRadius()) / kBlock_q;
         y <= (crater.y_q + crater.outerRadius()) / kBlock_q; ++y)
      for (std::int64_t x = (crater.x_q - crater.outerRadius()) / kBlock_q;
           x <= (crater.x_q + crater.outerRadius()) / kBlock_q; ++x)
        blocks.insert({x, y});
  return blocks.size();
}

void measureMemory() {
  constexpr double kTextureKb = 128 * 128 * 4 / 1024.0;  // one 32-bit height a sample
  std::printf(
      "figure 7: memory, kB; records and hash with cells of 500 m, beside texture blocks of 128 x 128 at 1 m\n");
  std::printf("  %8s %14s %10s %14s %10s %8s\n", "disc", "craters", "records", "with hash", "textures", "ratio");
  for (const double disc_m : {500.0, 10000.0}) {
    const ScenePack pack = makeField(disc_m, 1, 500);
    for (const std::size_t count : {10u, 100u, 250u, 500u, 1000u}) {
      const std::vector<Crater> craters = throwCraters(pack, disc_m, count);
      CraterSet set(pack);
      set.add(craters);
      const double held = double(set.memoryBytes()) / 1024, textures = double(touchedBlocks(craters)) * kTextureKb;
      std::printf("  %6.0f m %14zu %10.1f %14.1f %10.0f %8.1f\n", disc_m, count, double(count * sizeof(Crater)) / 1024,
                  held, textures, textures / held);
    }
  }
  std::printf("\n");
}

// ---- build and query

/// Every terrain cell of a tile through all records: what a query costs without a hash.
void fillFromAll(const std::vector<Crater>& craters, const ScenePack& pack, TileCoordinate at,
                 std::vector<std::int32_t>& out) {
  const CellBox box{at.x * rules::kTileSize, at.y * rules::kTileSize, (at.x + 1) * rules::kTileSize,
                    (at.y + 1) * rules::kTileSize};
  std::vector<rules::CraterSum> sums(rules::kTileCells, rules::craterSumOfNone());
  for (const Crater& crater : craters) {
    if (!craterBox(pack, crater).meets(box)) continue;
    const rules::CraterShape shape = shapeOf(crater);
    for (int i = 0; i < rules::kTileCells; ++i) {
      const int x = box.x0 + i % rules::kTileSize, y = box.y0 + i / rules::kTileSize;
      if (x >= pack.width_cells || y >= pack.height_cells) continue;
      sums[std::size_t(i)] =
          rules::withCrater(sums[std::size_t(i)],
                            rules::craterDisplacement(shape, x * pack.cell_q + pack.cell_q / 2 - shape.x,
                                                      y * pack.cell_q + pack.cell_q / 2 - shape.y),
                            shape.rim);
    }
  }
  std::ranges::transform(sums, out.begin(), rules::craterTotal);
}

void measureHash(Report& report) {
  constexpr double kDisc_m = 10000;
  constexpr int kQueries = 200;
  std::printf("spatial hash, craters of 5 to 20 m in a disc of %.0f m, hash cells of 75 m\n", kDisc_m);
  std::printf("  %9s %10s %12s %14s %16s %16s %8s\n", "craters", "build ms", "bytes each", "add one us",
              "ids of tile us", "through all us", "ratio");
  const ScenePack pack = makeField(kDisc_m, 0.5, 75);
  for (const std::size_t count : {std::size_t(1000), std::size_t(10000), std::size_t(100000), std::size_t(1000000)}) {
    std::vector<Crater> craters = throwCraters(pack, kDisc_m, count + kQueries);
    const std::vector<Crater> more(craters.begin() + std::ptrdiff_t(count), craters.end());
    craters.resize(count);
    CraterSet set(pack);
    auto start = Clock::now();
    set.add(craters);
    const double build_ms = millisecondsSince(start);
    const double bytes_each = double(set.memoryBytes()) / double(count);
    std::mt19937 engine(3);
    std::vector<double> query_us, all_us, add_us;
    const TileCoordinate extent = tileExtent(pack);
    std::vector<std::int32_t> filled(rules::kTileCells), expected(rules::kTileCells);
    for (int i = 0; i < kQueries; ++i) {
      const TileCoordinate at{drawn(engine, 0, extent.x - 1), drawn(engine, 0, extent.y - 1)};
      const std::int32_t x = at.x * rules::kTileSize, y = at.y * rules::kTileSize;
      start = Clock::now();
      const auto ids = set.meeting({x, y, x + rules::kTileSize, y + rules::kTileSize});
      query_us.push_back(millisecondsSince(start) * 1000);
      start = Clock::now();
      std::vector<std::uint32_t> among_all;
      for (const Crater& crater : craters)
        if (craterBox(pack, crater).meets({x, y, x + rules::kTileSize, y + rules::kTileSize}))
          among_all.push_back(crater.id);
      all_us.push_back(millisecondsSince(start) * 1000);
      if (ids != among_all) report.faults.push_back("craters: the hash finds other records than a search of all");
      if (i >= 20) continue;
      set.fill(x, y, 1, rules::kTileSize, rules::kTileSize, filled);
      fillFromAll(craters, pack, at, expected);
      if (filled != expected) report.faults.push_back("craters: ground by the hash differs from ground by all records");
    }
    for (const Crater& crater : more) {
      start = Clock::now();
      set.add({&crater, 1});
      add_us.push_back(millisecondsSince(start) * 1000);
    }
    const double query = percentile(query_us, 0.5), all = percentile(all_us, 0.5);
    std::printf("  %9zu %10.2f %12.1f %14.2f %16.2f %16.1f %8.0f\n", count, build_ms, bytes_each,
                percentile(add_us, 0.5), query, all, all / query);
  }
  std::printf("\n");
}

// ---- lazy beside eager

/// Dormant ground made at once: for every cell of the map what all craters do to it so far, crater by crater.
class EagerGround {
 public:
  explicit EagerGround(const BaseTerrain& base)
      : pack_(base.pack()),
        sums_(std::size_t(pack_.width_cells) * std::size_t(pack_.height_cells), rules::craterSumOfNone()) {}

  void add(const Crater& crater) {
    const CellBox box = craterBox(pack_, crater);
    const rules::CraterShape shape = shapeOf(crater);
    for (std::int32_t y = box.y0; y < box.y1; ++y)
      for (std::int32_t x = box.x0; x < box.x1; ++x) {
        rules::CraterSum& sum = sums_[std::size_t(y) * std::size_t(pack_.width_cells) + std::size_t(x)];
        sum = rules::withCrater(sum,
                                rules::craterDisplacement(shape, x * pack_.cell_q + pack_.cell_q / 2 - shape.x,
                                                          y * pack_.cell_q + pack_.cell_q / 2 - shape.y),
                                shape.rim);
        ++evaluated_;
      }
  }

  std::int32_t height(std::int32_t x, std::int32_t y, std::int32_t base_q) const {
    const auto& sum = sums_[std::size_t(y) * std::size_t(pack_.width_cells) + std::size_t(x)];
    return rules::craterGround(base_q, base_q - pack_.soil_depth_q, rules::craterTotal(sum));
  }
  std::int64_t evaluated() const { return evaluated_; }
  std::size_t bytes() const { return sums_.size() * sizeof(rules::CraterSum); }

 private:
  const ScenePack& pack_;
  std::vector<rules::CraterSum> sums_;
  std::int64_t evaluated_ = 0;
};

void measureLazy(Report& report) {
  constexpr double kDisc_m = 500;
  constexpr std::size_t kCount = 2000;
  const ScenePack pack = makeField(kDisc_m, 0.1, 75);
  const BaseTerrain base(pack);
  const std::vector<Crater> craters = throwCraters(pack, kDisc_m, kCount);
  auto start = Clock::now();
  EagerGround eager(base);
  for (const Crater& crater : craters) eager.add(crater);
  const double eager_ms = millisecondsSince(start);

  start = Clock::now();
  CraterSet set(pack);
  for (const Crater& crater : craters) set.add({&crater, 1});
  const double record_ms = millisecondsSince(start);
  const TileCoordinate extent = tileExtent(pack);
  std::vector<TileCoordinate> tiles;
  for (std::int32_t y = 0; y < extent.y; ++y)
    for (std::int32_t x = 0; x < extent.x; ++x) tiles.push_back({x, y});
  std::ranges::shuffle(tiles, std::mt19937(4));
  const std::size_t touched = tiles.size() / 100;
  start = Clock::now();
  std::vector<std::int32_t> displacement(rules::kTileCells);
  for (std::size_t i = 0; i < touched; ++i)
    set.fill(tiles[i].x * rules::kTileSize, tiles[i].y * rules::kTileSize, 1, rules::kTileSize, rules::kTileSize,
             displacement);
  const double touch_ms = millisecondsSince(start);

  const DormantGround dormant{&base, &set};
  PlaneCells lazy, ground;
  std::int64_t unequal = 0;
  for (const TileCoordinate at : tiles) {
    dormant.fillHeights(at, lazy);
    base.fillHeights(at, ground);
    for (int i = 0; i < rules::kTileCells; ++i) {
      const std::int32_t x = at.x * rules::kTileSize + i % rules::kTileSize;
      const std::int32_t y = at.y * rules::kTileSize + i / rules::kTileSize;
      if (x < pack.width_cells && y < pack.height_cells)
        unequal += lazy[std::size_t(i)] != eager.height(x, y, ground[std::size_t(i)]) ? 1 : 0;
    }
  }
  std::printf("lazy beside eager: %zu craters in a disc of %.0f m on cells of 0.1 m, %zu tiles, one processor\n",
              kCount, kDisc_m, tiles.size());
  std::printf("  eager: %.0f ms, %lld cells evaluated, %.0f MB\n", eager_ms, static_cast<long long>(eager.evaluated()),
              double(eager.bytes()) / 1e6);
  std::printf("  lazy, 1 %% of the tiles ever touched: records %.2f ms, tiles %.1f ms; work ratio %.4f, %.2f MB\n",
              record_ms, touch_ms, (record_ms + touch_ms) / eager_ms, double(set.memoryBytes()) / 1e6);
  std::printf("  cells that differ, of all the map: %lld\n\n", static_cast<long long>(unequal));
  if (unequal != 0) report.faults.push_back("craters: lazy and eager ground differ");
}

}  // namespace

void measureCraters(const Settings&, Report& report) {
  measureProfile(report);
  measureBalance();
  measureMemory();
  measureHash(report);
  measureLazy(report);
}

}  // namespace spoor
