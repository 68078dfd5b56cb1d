// The missing force: the force that the model lacks, measured by the observer.
//
// The observer adds a force, M y1', wherever the model alone would deviate from the recording
// (observer.h). Below the bandwidth of the observer this is the force on the arm that the model
// lacks, plus the noise of the measurement.
#pragma once

#include <vector>

#include "fit/estimate/estimate.h"

namespace axisfit {

struct MissingForce {
  bool found = false;   ///< false: neither velocity nor position was recorded, or it failed
  double cutoff = 0.0;  ///< Hz, of the zero-phase low-pass; the observer gain is 2 pi times that
  std::vector<double> force;    ///< N on the arm side, per sample, low-passed
  std::vector<Sample> samples;  ///< the axis at those samples
  double rms = 0.0;             ///< N, over the scored samples
  double noise = 0.0;           ///< N rms, what white noise of the stated size contributes
  double drive_rms = 0.0;  ///< N, of the drive force, low-passed alike: the size to compare with
};

/// The missing force beyond what noise makes of it, in per cent of the drive force; zero where it
/// is hardly more.
double percent_of_drive(const MissingForce& force);

/// The missing force of one recording, with the parameters of a fit. The cutoff is 40 Hz, halved
/// while noise makes more than 1 % of the largest drive force, down to 5 Hz.
MissingForce missing_force(const Job& job, const FitResult& result, std::size_t recording);

/// Of every recording.
std::vector<MissingForce> missing_forces(const Job& job, const FitResult& result);

}  // namespace axisfit
