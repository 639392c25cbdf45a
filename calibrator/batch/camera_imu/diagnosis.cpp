// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/camera_imu/diagnosis.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrator/base/option_check.h"
#include "calibrator/batch/camera_imu/effective_scores.h"

namespace plumbline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kEdge = 0.1;  // share of the recording on either side in which no change is sought

/// Inverse of a positive matrix of mixed units: scaled to a unit diagonal first, and kept finite by
/// a prior far weaker than what is measured.
MatrixXd inverseOf(const MatrixXd& A) {
  const VectorXd scale = A.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  MatrixXd scaled = scale.asDiagonal() * A * scale.asDiagonal();
  scaled.diagonal().array() += 1e-12;
  const MatrixXd inverse = scaled.ldlt().solve(MatrixXd::Identity(A.rows(), A.cols()));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// A column of the scores that acts from a block on.
struct Term {
  int column = 0;
  std::size_t from = 0;
};
using Terms = std::vector<Term>;

Terms range(int first, int count, std::size_t from = 0) {
  Terms out;
  for (int k = 0; k < count; ++k) out.push_back({first + k, from});
  return out;
}

/// The scores about any terms: sums over the blocks in which they act.
class Scores {
 public:
  explicit Scores(std::vector<ScoreBlock> blocks) : blocks_(std::move(blocks)), tails_(blocks_) {
    for (std::size_t b = tails_.size() - 1; b-- > 0;) {
      tails_[b].gradient += tails_[b + 1].gradient;
      tails_[b].information += tails_[b + 1].information;
    }
  }

  std::size_t count() const { return blocks_.size(); }
  TimeNs begin(std::size_t block) const { return blocks_[block].begin; }

  VectorXd gradient(const Terms& terms) const {
    VectorXd out(static_cast<Index>(terms.size()));
    for (std::size_t i = 0; i < terms.size(); ++i) {
      out(static_cast<Index>(i)) = tails_[terms[i].from].gradient(terms[i].column);
    }
    return out;
  }
  MatrixXd information(const Terms& a, const Terms& b) const {
    return matrix(a, b, [&](const Term& p, const Term& q) {
      return tails_[std::max(p.from, q.from)].information(p.column, q.column);
    });
  }
  /// The same of one block.
  VectorXd gradient(const Terms& terms, std::size_t block) const {
    VectorXd out(static_cast<Index>(terms.size()));
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const bool acts = block >= terms[i].from;
      out(static_cast<Index>(i)) = acts ? blocks_[block].gradient(terms[i].column) : 0.0;
    }
    return out;
  }
  MatrixXd information(const Terms& a, const Terms& b, std::size_t block) const {
    return matrix(a, b, [&](const Term& p, const Term& q) {
      const bool act = block >= std::max(p.from, q.from);
      return act ? blocks_[block].information(p.column, q.column) : 0.0;
    });
  }

 private:
  template <class Entry>
  static MatrixXd matrix(const Terms& a, const Terms& b, const Entry& entry) {
    MatrixXd out(static_cast<Index>(a.size()), static_cast<Index>(b.size()));
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) {
        out(static_cast<Index>(i), static_cast<Index>(j)) = entry(a[i], b[j]);
      }
    }
    return out;
  }

  std::vector<ScoreBlock> blocks_;
  std::vector<ScoreBlock> tails_;  // sums from a block to the end
};

/// T_SC0 and the time offset among the first columns, which are the border's.
Eigen::Matrix<double, 7, 1> listed(const VectorXd& model) {
  Eigen::Matrix<double, 7, 1> out;
  out << model.head<6>(), model(BorderLayout::kOffset);
  return out;
}

/// chi2 as a deviate of the normal distribution (Wilson and Hilferty 1931).
double significanceOf(double chi2, int dof) {
  const double v = 2.0 / (9.0 * dof);
  return (std::cbrt(chi2 / dof) - (1 - v)) / std::sqrt(v);
}

/// Score tests beside a model: the calibration's parameters, and faults that were accepted.
class ScoreTests {
 public:
  ScoreTests(const Scores& scores, Terms model)
      : scores_(scores),
        model_(std::move(model)),
        S_(inverseOf(scores.information(model_, model_))),
        gradient_(scores.gradient(model_)) {
    MatrixXd V = MatrixXd::Zero(S_.rows(), S_.cols());
    for (std::size_t b = 0; b < scores.count(); ++b) {
      const VectorXd s =
          scores.gradient(model_, b) - scores.information(model_, model_, b) * (S_ * gradient_);
      V += s * s.transpose();
    }
    const auto n = static_cast<double>(scores.count());
    robust_variance_ = n / (n - 1) * (S_ * V * S_).diagonal();
  }

  const Terms& model() const { return model_; }
  Eigen::Matrix<double, 7, 1> robustStd() const { return listed(robust_variance_.cwiseSqrt()); }
  Eigen::Matrix<double, 7, 1> formalStd() const { return listed(S_.diagonal().cwiseSqrt()); }

  /// How T_SC0 and the time offset follow parameters that are held.
  MatrixXd response(const Terms& held) const {
    const MatrixXd P = -(S_ * scores_.information(model_, held));
    MatrixXd out(7, P.cols());
    out << P.topRows<6>(), P.row(BorderLayout::kOffset);
    return out;
  }

  FaultTest test(const Terms& fault) const {
    const MatrixXd I = scores_.information(fault, model_);
    const MatrixXd P = S_ * I.transpose();  // minus the model's response to the fault
    const MatrixXd A_inverse = inverseOf(scores_.information(fault, fault) - I * P);
    const VectorXd s = scores_.gradient(fault) - P.transpose() * gradient_;
    FaultTest out;
    out.dof = static_cast<int>(fault.size());
    out.estimate = -A_inverse * s;
    const MatrixXd C = A_inverse * scatter(fault, P, out.estimate) * A_inverse;
    out.std = C.diagonal().cwiseSqrt();
    const double explained = s.dot(A_inverse * s);
    out.explained = explained / overdispersion();
    out.chi2 = std::min(out.estimate.dot(inverseOf(C) * out.estimate), out.explained);
    out.significance = significanceOf(out.chi2, out.dof);
    out.shift = listed(-(P * out.estimate));
    out.shift_sigma = out.shift.cwiseAbs().cwiseQuotient(robustStd()).maxCoeff();
    return out;
  }

  /// By how much the calibration's robust variances exceed the formal ones, in the mean of logs.
  double overdispersion() const {
    const Eigen::Array<double, 7, 1> ratio =
        robustStd().array().max(1e-30) / formalStd().array().max(1e-30);
    return std::exp(2 * ratio.log().mean());
  }

 private:
  /// Sum of s s' over blocks of the fault's scores, with fault and model at their estimates.
  MatrixXd scatter(const Terms& fault, const MatrixXd& P, const VectorXd& estimate) const {
    MatrixXd V = MatrixXd::Zero(P.cols(), P.cols());
    const VectorXd step = -S_ * gradient_ - P * estimate;  // of the model, with the fault
    for (std::size_t b = 0; b < scores_.count(); ++b) {
      const MatrixXd I = scores_.information(fault, model_, b);
      const VectorXd of_fault =
          scores_.gradient(fault, b) + I * step + scores_.information(fault, fault, b) * estimate;
      const VectorXd of_model = scores_.gradient(model_, b) + I.transpose() * estimate +
                                scores_.information(model_, model_, b) * step;
      const VectorXd s = of_fault - P.transpose() * of_model;
      V += s * s.transpose();
    }
    const auto n = static_cast<double>(scores_.count());
    return n / std::max(1.0, n - 1 - static_cast<double>(fault.size())) * V;
  }

  const Scores& scores_;
  const Terms model_;
  const MatrixXd S_;
  const VectorXd gradient_;
  VectorXd robust_variance_;
};

/// A fault with its columns.
struct Candidate {
  UnmodelledFault fault{};
  int camera = -1;
  std::vector<int> columns;
  bool begins = false;                   ///< at an instant
  std::vector<int> nuisance{};           ///< free beside it, though the batch holds them
  std::optional<TimeNs> at{};            ///< where its instant was found already
  std::optional<double> frequency_hz{};  ///< likewise its frequency
  int changes = 0;                       ///< at so many instants, evenly spaced
  double dispersion = 0;                 ///< of what it explains by chance, where that is known
};

std::vector<int> columnRange(int first, int count) {
  std::vector<int> out;
  for (int k = 0; k < count; ++k) out.push_back(first + k);
  return out;
}

/// What a calibration of the cameras has adapted to the target: their lenses and distances.
std::vector<int> cameraColumns(const FaultColumns& columns, const CameraImuEstimate& estimate) {
  std::vector<int> out;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    const auto count = static_cast<int>(estimate.cameras[c].intrinsics.stacked().size());
    for (int k = 0; k < count; ++k) out.push_back(columns.intrinsics[c] + k);
    for (int k = 0; c > 0 && k < 6; ++k) out.push_back(columns.T_C0Ci[c] + k);
  }
  return out;
}

std::vector<Candidate> candidates(const FaultColumns& columns, const CameraImuEstimate& estimate,
                                  const EffectiveScores& found) {
  const int a = columns.samples + SampleFaults::kAccel;
  const int g = columns.samples + SampleFaults::kGyro;
  const auto diagonal = [](int m) { return std::vector<int>{m, m + 4, m + 8}; };
  const auto rest = [](int m) {
    return std::vector<int>{m + 1, m + 2, m + 3, m + 5, m + 6, m + 7};
  };
  // Jumps are measured against the stated walk of the biases, which a pixel_sigma that is too large
  // does not touch, though the calibration's deviations do shrink by it.
  constexpr double kWalk = 1;
  std::vector<Candidate> out = {
      {UnmodelledFault::kAccelScale, -1, diagonal(a)},
      {UnmodelledFault::kAccelMisalignment, -1, rest(a)},
      {UnmodelledFault::kGyroScale, -1, diagonal(g)},
      {UnmodelledFault::kGyroMisalignment, -1, rest(g)},
      {UnmodelledFault::kGSensitivity, -1,
       columnRange(columns.samples + SampleFaults::kGSensitivity, 9)},
      {UnmodelledFault::kImuDelay, -1, {columns.samples + SampleFaults::kDelay}},
      {UnmodelledFault::kClockDrift, -1, {columns.drift}},
      {UnmodelledFault::kLineDelay, -1, {columns.line_delay}},
      {UnmodelledFault::kTargetSize, -1, {columns.target_size}},
      {UnmodelledFault::kImuMoved, -1, columnRange(BorderLayout::kExtrinsics, 6), true},
      {UnmodelledFault::kClockStep, -1, {BorderLayout::kOffset}, true},
      {UnmodelledFault::kTargetShape, -1, columnRange(columns.shape, FaultColumns::kShape), false,
       cameraColumns(columns, estimate)},
      {UnmodelledFault::kTargetMoved,
       -1,
       columnRange(columns.target_jump, 3),
       false,
       {},
       found.jumps.target_at,
       {},
       0,
       found.jumps.target_dispersion},
      {UnmodelledFault::kTargetSways,
       -1,
       columnRange(columns.sway, 6),
       false,
       {},
       {},
       found.sway_hz},
      {UnmodelledFault::kGyroBiasJump,
       -1,
       columnRange(columns.gyro_jump, 3),
       false,
       {},
       found.jumps.gyro_at,
       {},
       0,
       kWalk},
      {UnmodelledFault::kAccelBiasJump,
       -1,
       columnRange(columns.accel_jump, 3),
       false,
       {},
       found.jumps.accel_at,
       {},
       0,
       kWalk},
      {UnmodelledFault::kStampsWander, -1, {BorderLayout::kOffset}, false, {}, {}, {}, 7}};
  for (std::size_t c = 1; c < columns.T_C0Ci.size(); ++c) {
    const int camera = static_cast<int>(c);
    if (columns.own_offset[c] >= columns.border.size) {
      out.push_back({UnmodelledFault::kCameraDelay, camera, {columns.own_offset[c]}});
    }
    out.push_back({UnmodelledFault::kCameraMoved, camera, columnRange(columns.T_C0Ci[c], 6), true});
  }
  return out;
}

/// The cameras' parameters in the order of their own stage, then the board's terms.
Terms heldCameras(const FaultColumns& columns, const CameraImuEstimate& estimate) {
  Terms out;
  const auto add = [&](int first, int count) {
    for (const Term& term : range(first, count)) out.push_back(term);
  };
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    add(columns.intrinsics[c], static_cast<int>(estimate.cameras[c].intrinsics.stacked().size()));
  }
  for (std::size_t c = 1; c < estimate.cameras.size(); ++c) add(columns.T_C0Ci[c], 6);
  add(columns.shape, FaultColumns::kShape);
  return out;
}

/// A test with the terms that take the fault into the model.
struct Tested {
  FaultTest test;
  Terms terms;
  /// By Schwarz's criterion: what the fault explains, less what any would by chance.
  double evidence(std::size_t blocks) const {
    return test.explained - test.dof * std::log(static_cast<double>(blocks));
  }
};

/// The model with columns over the whole recording, without repeating one.
Terms withColumns(Terms model, const std::vector<int>& columns) {
  for (const int column : columns) {
    const bool there = std::any_of(model.begin(), model.end(), [&](const Term& t) {
      return t.column == column && t.from == 0;
    });
    if (!there) model.push_back({column, 0});
  }
  return model;
}

Tested tested(const Scores& scores, const ScoreTests& tests, const Candidate& candidate) {
  Tested out;
  if (candidate.changes > 0) {
    const auto parts = static_cast<std::size_t>(candidate.changes) + 1;
    for (std::size_t k = 1; k < parts; ++k) {
      out.terms.push_back({candidate.columns.front(), k * scores.count() / parts});
    }
    out.test = tests.test(out.terms);
  } else if (!candidate.begins) {
    for (const int column : candidate.columns) out.terms.push_back({column, 0});
    if (candidate.nuisance.empty()) {
      out.test = tests.test(out.terms);
    } else {
      const ScoreTests beside(scores, withColumns(tests.model(), candidate.nuisance));
      out.test = beside.test(out.terms);
    }
    if (candidate.dispersion > tests.overdispersion()) {
      const double share = tests.overdispersion() / candidate.dispersion;
      out.test.explained *= share;
      out.test.chi2 = std::min(out.test.chi2, out.test.explained);
      out.test.significance = significanceOf(out.test.chi2, out.test.dof);
    }
    out.test.since = candidate.at;
    out.test.frequency_hz = candidate.frequency_hz;
  } else {
    const ScoreTests changes(scores, withColumns(tests.model(), candidate.columns));
    const auto n = static_cast<double>(scores.count());
    const auto edge = static_cast<std::size_t>(std::max(3.0, std::ceil(kEdge * n)));
    for (std::size_t b = edge; b + edge <= scores.count(); ++b) {
      Terms terms;
      for (const int column : candidate.columns) terms.push_back({column, b});
      FaultTest test = changes.test(terms);
      if (!out.terms.empty() && !(test.chi2 > out.test.chi2)) continue;
      out = {std::move(test), std::move(terms)};
      out.test.since = scores.begin(b);
    }
  }
  out.test.fault = candidate.fault;
  out.test.camera = candidate.camera;
  return out;
}

bool isSignificant(const FaultTest& test, const DiagnosisOptions& options) {
  if (test.frequency_hz) return test.significance > options.significance_frequency;
  return test.significance > (test.since ? options.significance_since : options.significance);
}

/// Faults of the stamps, each of which looks like the others.
bool isOfClock(UnmodelledFault fault) {
  return fault == UnmodelledFault::kClockDrift || fault == UnmodelledFault::kClockStep ||
         fault == UnmodelledFault::kStampsWander;
}

/// Whether a fault is one of its own beside causes that were found. What begins when a cause does
/// is the same event, whose instant is known to a block. Where the first cause moves the
/// calibration far, its own terms of second order look like other faults.
bool standsAlone(const FaultTest& test, const FaultDiagnosis& found, double block_s) {
  constexpr double kSameEvent = 2;  // blocks
  constexpr double kFar = 20;       // formal deviations
  constexpr double kShare = 1.0 / 3;
  for (const FaultTest& cause : found.causes) {
    if (isOfClock(test.fault) && isOfClock(cause.fault)) return false;
    if (!test.since || !cause.since) continue;
    if (std::abs(secondsBetween(*cause.since, *test.since)) < kSameEvent * block_s) return false;
  }
  if (found.causes.empty()) return true;
  const FaultTest& first = found.causes.front();
  const double far = first.shift.cwiseAbs().cwiseQuotient(found.formal_std).maxCoeff();
  return far < kFar || test.explained > kShare * first.explained;
}

/// Takes the faults that explain most into the model, one after the other.
void findCauses(const Scores& scores, const std::vector<Candidate>& all, Terms model,
                const DiagnosisOptions& options, FaultDiagnosis& out) {
  for (int round = 0; round < options.most_causes; ++round) {
    const ScoreTests tests(scores, model);
    std::vector<Tested> significant;
    for (const Candidate& candidate : all) {
      Tested t = tested(scores, tests, candidate);
      if (round == 0) out.tests.push_back(t.test);
      if (isSignificant(t.test, options) && standsAlone(t.test, out, options.block_s)) {
        significant.push_back(std::move(t));
      }
    }
    if (significant.empty()) return;
    std::sort(significant.begin(), significant.end(), [&](const Tested& a, const Tested& b) {
      return a.evidence(scores.count()) > b.evidence(scores.count());
    });
    const Tested& first = significant.front();
    out.causes.push_back(first.test);
    if (round == 0 && significant.size() > 1 &&
        significant[1].test.explained > options.alike * first.test.explained) {
      out.alternative = significant[1].test;
    }
    model.insert(model.end(), first.terms.begin(), first.terms.end());
  }
}

}  // namespace

void DiagnosisOptions::check() const {
  requirePositive("DiagnosisOptions.block_s", block_s);
  requireAtLeast(4, "DiagnosisOptions.fewest_blocks", fewest_blocks);
  requirePositive("DiagnosisOptions.significance", significance);
  requirePositive("DiagnosisOptions.significance_since", significance_since);
  requirePositive("DiagnosisOptions.significance_frequency", significance_frequency);
  requireAtLeast(0, "DiagnosisOptions.most_causes", most_causes);
  requireWithin(0, 1, "DiagnosisOptions.alike", alike);
}

std::optional<FaultDiagnosis> diagnoseFaults(const CameraImuProblem& problem,
                                             const CameraImuSolution& solution,
                                             const DiagnosisOptions& options) {
  options.check();
  const FaultColumns columns(solution.estimate, problem.free_cameras);
  auto found = effectiveScores(problem, solution, columns, options.block_s);
  if (!found || found->blocks.size() < static_cast<std::size_t>(options.fewest_blocks)) {
    return std::nullopt;
  }
  const Scores scores(std::move(found->blocks));
  const Terms model = range(0, columns.border.size);
  FaultDiagnosis out;
  const ScoreTests tests(scores, model);
  out.robust_std = tests.robustStd();
  out.formal_std = tests.formalStd();
  if (!problem.free_cameras) {
    out.by_cameras = tests.response(heldCameras(columns, solution.estimate));
  }
  findCauses(scores, candidates(columns, solution.estimate, *found), model, options, out);
  return out;
}

}  // namespace plumbline
