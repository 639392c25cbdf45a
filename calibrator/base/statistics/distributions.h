// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Boost's distributions, whose headers take compilers seconds, are read in distributions.cpp alone.
// `share` is P(X <= x) of a quantile, `tail` P(X > x).

namespace plumbline {

double normalShare(double x);
double normalTail(double x);
double normalQuantile(double share);
double normalTailQuantile(double tail);

/// Student's t.
double studentsTail(double dof, double t);
double studentsQuantile(double dof, double share);

double chiSquaredQuantile(double dof, double share);
double chiSquaredTailQuantile(double dof, double tail);

/// Fisher's F.
double fisherTail(double dof1, double dof2, double f);
double fisherTailQuantile(double dof1, double dof2, double tail);

/// P(at most `successes` in n trials) with a chance of 1/2 each.
double coinShare(double n, double successes);

}  // namespace plumbline
