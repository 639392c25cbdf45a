// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "report/plots/svg.h"

namespace plumbline {

Colour seriesColour(std::size_t i) {
  static constexpr std::array<Colour, 7> kCycle = {{{0, 94, 162, 255},
                                                    {213, 94, 0, 255},
                                                    {0, 138, 100, 255},
                                                    {180, 70, 140, 255},
                                                    {200, 140, 0, 255},
                                                    {70, 150, 210, 255},
                                                    {90, 90, 90, 255}}};
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
  static constexpr std::array<Colour, 10> kStops = {{{0, 34, 78, 255},
                                                     {18, 53, 112, 255},
                                                     {59, 73, 108, 255},
                                                     {87, 93, 109, 255},
                                                     {112, 113, 115, 255},
                                                     {138, 134, 120, 255},
                                                     {165, 156, 116, 255},
                                                     {195, 179, 105, 255},
                                                     {225, 204, 85, 255},
                                                     {254, 232, 56, 255}}};
  return between(kStops, u);
}

// White in the middle, where zero is, and equally dark at both ends: the hue alone tells the sign.
Colour divergingColour(double u) {
  static constexpr std::array<Colour, 5> kStops = {{{33, 76, 148, 255},
                                                    {132, 172, 214, 255},
                                                    {250, 250, 250, 255},
                                                    {232, 152, 122, 255},
                                                    {168, 34, 44, 255}}};
  return between(kStops, u);
}

// Viridis (van der Walt and Smith, 2015) backwards, without its palest quarter, which is not seen
// as a line on white: what is far off is dark.
Colour errorColour(double u) {
  static constexpr std::array<Colour, 5> kStops = {{{94, 201, 98, 255},
                                                    {33, 165, 133, 255},
                                                    {42, 120, 142, 255},
                                                    {65, 68, 135, 255},
                                                    {68, 1, 84, 255}}};
  return between(kStops, u);
}

}  // namespace internal
}  // namespace plumbline
