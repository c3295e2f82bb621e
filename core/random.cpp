#include "core/random.h"

#include <Random123/philox.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/normal.h"

namespace npdr {
namespace {

// SplitMix64's finalizer: every input bit flips every output bit with probability near 1/2.
std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::uint64_t stream_key(const StreamId& id) {
  std::uint64_t h = mix(id.seed);
  for (const char c : id.name) h = mix(h ^ static_cast<unsigned char>(c));
  h = mix(h ^ mix(id.round));
  return mix(h ^ mix(id.epoch + 0x632be59bd9b4e019ULL));
}

// log(v) for v in (0, 1], cos and sin of 2 pi w for w in [0, 1): polynomials without branches, so
// that loops over them vectorize and give the same bits in every lane. Absolute errors below 1e-6.
float fast_log(float v) {
  const auto b = std::bit_cast<std::uint32_t>(v);
  // Split v = m 2^e with m in [sqrt(1/2), sqrt(2)).
  const auto shifted = b - 0x3f3504f3u;
  const auto e = static_cast<float>(static_cast<std::int32_t>(shifted) >> 23);
  const float m = std::bit_cast<float>((shifted & 0x007fffffu) + 0x3f3504f3u);
  const float f = m - 1.0f;
  const float s = f / (2.0f + f);  // log m = 2 atanh(s)
  const float s2 = s * s;
  const float series =
      2.0f * s * (1.0f + s2 * (1.0f / 3.0f + s2 * (0.2f + s2 * (1.0f / 7.0f + s2 / 9.0f))));
  return e * 0.69314718f + series;
}

// sin(2 pi w) for w in [-1/4, 1/4], Taylor to the eleventh order.
float sin_quarter(float w) {
  const float x = 6.2831853f * w;
  const float x2 = x * x;
  return x *
         (1.0f + x2 * (-1.0f / 6.0f +
                       x2 * (1.0f / 120.0f +
                             x2 * (-1.0f / 5040.0f + x2 * (1.0f / 362880.0f - x2 / 39916800.0f)))));
}

// Folds w in [0, 1) to [-1/4, 1/4] so that sin(2 pi w) is kept.
float fold(float w) {
  const float centered = w - static_cast<float>(w >= 0.75f);
  return centered > 0.25f ? 0.5f - centered : centered;
}

void box_muller(std::uint32_t a, std::uint32_t b, float& first, float& second) {
  const float v = (static_cast<float>(a >> 8) + 0.5f) * 0x1p-24f;
  const float w = static_cast<float>(b >> 8) * 0x1p-24f;
  const float r = std::sqrt(-2.0f * fast_log(v));
  const float w_cos = w + 0.25f;
  first = r * sin_quarter(fold(w_cos - static_cast<float>(w_cos >= 1.0f)));
  second = r * sin_quarter(fold(w));
}

}  // namespace

StreamId named(StreamId id, std::string_view name) {
  id.name = name;
  return id;
}

StreamId within(StreamId id, std::string_view name) {
  for (const char c : id.name) id.seed = mix(id.seed ^ static_cast<unsigned char>(c));
  return named(id, name);
}

StreamId row_after(StreamId id, std::int64_t count) {
  id.row += static_cast<std::uint64_t>(count);
  return id;
}

Stream::Stream(const StreamId& id) {
  const std::uint64_t key = stream_key(id);
  key_ = {low_word(key), high_word(key)};
  counter_ = {0, 0, low_word(id.row), high_word(id.row)};
}

std::uint32_t Stream::bits() {
  if (used_ == 4) {
    const r123::Philox4x32::ctr_type c = {{counter_[0], counter_[1], counter_[2], counter_[3]}};
    const auto out = r123::Philox4x32{}(c, r123::Philox4x32::key_type{{key_[0], key_[1]}});
    std::copy(out.begin(), out.end(), block_.begin());
    if (++counter_[0] == 0) ++counter_[1];
    used_ = 0;
  }
  return block_[static_cast<std::size_t>(used_++)];
}

double Stream::uniform() {
  const std::uint64_t a = bits();
  const std::uint64_t b = bits();
  const std::uint64_t mantissa = (a << 21) | (b >> 11);  // 53 bits
  // Above 1/2 rounding takes the half away, and from the largest mantissa it would give 1.
  return std::min((static_cast<double>(mantissa) + 0.5) * 0x1p-53, 0x1.fffffffffffffp-1);
}

double Stream::normal() { return normal_quantile(uniform()); }

std::uint32_t Stream::below(std::uint32_t n) {
  std::uint64_t product = std::uint64_t{bits()} * n;
  if (low_word(product) < n) {
    const std::uint32_t threshold = (0u - n) % n;
    while (low_word(product) < threshold) product = std::uint64_t{bits()} * n;
  }
  return high_word(product);
}

void Stream::fill_bits(std::span<std::uint32_t, kPhiloxWords> words) {
  std::array<std::uint32_t, kPhiloxWords> fresh;
  philox(counter_, key_, fresh);
  advance_philox(counter_);
  // First what is left of the last block; as much is left of the new last one.
  const auto rest = std::copy(block_.begin() + used_, block_.end(), words.begin());
  std::copy_n(fresh.begin(), words.end() - rest, rest);
  std::copy_n(fresh.end() - 4, 4, block_.begin());
}

void Stream::fill_normal(std::span<float> values) {
  constexpr std::size_t chunk = kPhiloxWords;
  std::array<std::uint32_t, chunk> raw;
  std::array<float, chunk> normals;
  for (std::size_t begin = 0; begin < values.size(); begin += chunk) {
    fill_bits(raw);
#pragma omp simd
    for (std::size_t i = 0; i < chunk / 2; ++i) {
      box_muller(raw[i], raw[i + chunk / 2], normals[i], normals[i + chunk / 2]);
    }
    const std::size_t count = std::min(chunk, values.size() - begin);
    std::copy_n(normals.begin(), count, values.begin() + static_cast<std::ptrdiff_t>(begin));
  }
}

std::vector<std::uint32_t> Stream::permutation(std::uint32_t n) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  for (std::uint32_t i = n; i > 1; --i) std::swap(order[i - 1], order[below(i)]);
  return order;
}

}  // namespace npdr
