/// Random numbers that are a function of what they are for, never of when they were drawn.
///
/// The generator is Philox4x32-10 (Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2,
/// 3", from Random123). A stream is named by its identity (study seed, stream name, round, row,
/// epoch), so any row can be recomputed alone, on any thread, shard or node, with the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/philox.h"

namespace npdr {

/// Identity of a stream of random numbers: what it is for.
struct StreamId {
  std::uint64_t seed = 0;   ///< the study seed of the experiment
  std::string_view name;    ///< the purpose, such as "prior" or "observation_noise"
  std::uint64_t round = 0;  ///< inference round, counted from 1 (0: none)
  std::uint64_t row = 0;    ///< the simulation, sample or batch
  std::uint64_t epoch = 0;  ///< passes over the same row
};

/// The stream for another purpose of the same experiment, round, row and epoch.
StreamId named(StreamId id, std::string_view name);

/// A stream for a purpose that serves that of `id`: other numbers for each of them.
StreamId within(StreamId id, std::string_view name);

/// The stream of the row that comes `count` rows after that of `id`.
StreamId row_after(StreamId id, std::int64_t count);

/// One stream of random numbers. Cheap to make; not thread-safe: make one per row.
class Stream {
 public:
  explicit Stream(const StreamId& id);

  /// 32 uniformly distributed bits.
  std::uint32_t bits();

  /// Uniform on the open interval (0, 1), a multiple of 2^-53 plus 2^-54.
  double uniform();

  /// Standard normal, by inversion of one uniform (normal_quantile).
  double normal();

  /// Uniform on {0, ..., n - 1}, without modulo bias (Lemire 2019). n >= 1.
  std::uint32_t below(std::uint32_t n);

  /// Fills `values` with standard normals by the Box-Muller transform in single precision
  /// (absolute error under 1e-6; |value| < 5.9). Much faster than normal() and vectorized.
  void fill_normal(std::span<float> values);

  /// A uniformly random permutation of 0, ..., n - 1 (Fisher and Yates).
  std::vector<std::uint32_t> permutation(std::uint32_t n);

 private:
  // The next words of bits(), many at once.
  void fill_bits(std::span<std::uint32_t, kPhiloxWords> words);

  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  int used_ = 4;
};

}  // namespace npdr
