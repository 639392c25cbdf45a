// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "report/plots/svg.h"

namespace plumbline {
namespace {

/// As "#rrggbb" of the web.
constexpr Colour fromHex(unsigned rgb) {
  return {static_cast<std::uint8_t>(rgb >> 16U & 255U), static_cast<std::uint8_t>(rgb >> 8U & 255U),
          static_cast<std::uint8_t>(rgb & 255U)};
}

}  // namespace

Colour seriesColour(std::size_t i) {
  static constexpr std::array<Colour, 7> kCycle = {
      fromHex(0x005ea2), fromHex(0xd55e00), fromHex(0x008a64), fromHex(0xb4468c),
      fromHex(0xc88c00), fromHex(0x4696d2), fromHex(0x5a5a5a)};
  Colour colour = kCycle[i % kCycle.size()];
  const std::size_t round = i / kCycle.size();
  if (round == 0) return colour;
  // Duller in further rounds, and no colour twice: hover.js knows a series by its colour.
  for (std::uint8_t* part : {&colour.red, &colour.green, &colour.blue}) {
    *part = static_cast<std::uint8_t>((*part + 128) / 2);
  }
  colour.red = static_cast<std::uint8_t>(colour.red + std::min<std::size_t>(round - 1, 80));
  return colour;
}

namespace internal {
namespace {

template <std::size_t N>
Colour between(const std::array<Colour, N>& stops, double u) {
  const double place = std::clamp(u, 0.0, 1.0) * (N - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), N - 2);
  const double f = place - static_cast<double>(i);
  const auto mix = [f](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + f * (b - a)));
  };
  return {mix(stops[i].red, stops[i + 1].red), mix(stops[i].green, stops[i + 1].green),
          mix(stops[i].blue, stops[i + 1].blue), 255};
}

}  // namespace

// Cividis: even steps of lightness for colour-blind readers too (Nunez, Anderton, Renslow, PLoS ONE
// 13(7), 2018), at ten of its places.
Colour sequentialColour(double u) {
  static constexpr std::array<Colour, 10> kStops = {
      fromHex(0x00224e), fromHex(0x123570), fromHex(0x3b496c), fromHex(0x575d6d),
      fromHex(0x707173), fromHex(0x8a8678), fromHex(0xa59c74), fromHex(0xc3b369),
      fromHex(0xe1cc55), fromHex(0xfee838)};
  return between(kStops, u);
}

// White in the middle, where zero is, and equally dark at both ends: the hue alone tells the sign.
Colour divergingColour(double u) {
  static constexpr std::array<Colour, 5> kStops = {fromHex(0x214c94), fromHex(0x84acd6),
                                                   fromHex(0xfafafa), fromHex(0xe8987a),
                                                   fromHex(0xa8222c)};
  return between(kStops, u);
}

// Viridis (van der Walt and Smith, 2015) backwards, without its palest quarter, which is not seen
// as a line on white: what is far off is dark.
Colour errorColour(double u) {
  static constexpr std::array<Colour, 5> kStops = {fromHex(0x5ec962), fromHex(0x21a585),
                                                   fromHex(0x2a788e), fromHex(0x414487),
                                                   fromHex(0x440154)};
  return between(kStops, u);
}

}  // namespace internal
}  // namespace plumbline
