// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace plumbline {

/// Small dense algebra on rows of doubles whose number of columns is a multiple of kRowLanes.
/// Compiled for plain x86-64 and for AVX2 with fused multiply-add; the machine decides when the
/// program starts. Both agree to rounding.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
inline constexpr int kRowLanes = 4;

/// (A | B) becomes L^-1 (A | B) = (L' | L^-1 B) with A = L L', n x n, the first n columns of n
/// rows; of A the upper triangle is read, and below it stands nothing of use afterwards. False
/// where a pivot is not positive.
[[nodiscard]] bool factoriseRows(RowMatrix& rows);

/// gram += P' P, upper triangle (and what shares lanes with it), P the columns of `rows` from
/// `first` (a multiple of kRowLanes) on.
void addGram(const RowMatrix& rows, int first, RowMatrix& gram);

/// U^-1 B, U the upper triangle of the first columns of `rows`, n x n, and B n x k.
RowMatrix solveUpper(const RowMatrix& rows, RowMatrix B);

/// A B, with any number of rows and columns of A.
RowMatrix product(const RowMatrix& A, const RowMatrix& B);

}  // namespace plumbline
