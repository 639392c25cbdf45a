// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "datasets/bag/choose_topics.h"
#include "datasets/bag/message_faults.h"
#include "datasets/bag/sensor_import.h"
#include "datasets/bag/sensor_summary.h"

namespace plumbline {

void ImuImport::take(const BagMessage& message, std::size_t number) {
  const auto sample = decodeImu(message);
  if (!sample) throw cutMessage(message, number, kImuType);
  checkedStamp(sample->t, topic_, number);
  if (!sample->gyro.allFinite() || !sample->accel.allFinite()) {
    throw messageFault(
        InputFault::kNotFinite, topic_,
        fmt::format("message {} has a rate or acceleration that is nan or inf", number));
  }
  const auto [known, is_new] = samples_.try_emplace(sample->t, *sample);
  if (is_new) return;
  if (known->second.gyro != sample->gyro || known->second.accel != sample->accel) {
    throw twoWithOneStamp(topic_, number, sample->t);
  }
  ++repeated_;
}

ImuStream ImuImport::stream(const ImuNoise& noise) const {
  ImuStream imu{topic_, noise, {}};
  bool turns = false, feels = false;
  for (const auto& [t, sample] : samples_) {
    imu.samples.push_back(sample);
    turns |= !sample.gyro.isZero(0);
    feels |= !sample.accel.isZero(0);
  }
  if (turns && feels) return imu;
  throw messageFault(InputFault::kEmpty, topic_,
                     fmt::format("every {} is 0; expected angular rates and specific forces in one "
                                 "topic; let the driver unite them (RealSense: unite_imu_method) "
                                 "and record again",
                                 turns ? "linear_acceleration" : "angular_velocity"));
}

ImportedSensor ImuImport::summary() const {
  return summaryOf({"imu0", topic_, {}, 0, repeated_}, samples_);
}

}  // namespace plumbline
