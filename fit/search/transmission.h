// A transmission that was taken to be rigid gives way, or has backlash: as hypotheses.
//
// Neither is a force that could be added to the equations: they are another variant of them, in
// which motor and arm move each for itself. So there is no derivative at zero, and the score test
// simulates them at a few sizes.
#pragma once

#include <vector>

#include "fit/data/job.h"
#include "fit/search/catalogue.h"

namespace axisfit {

/// For a rigid transmission `compliance`, with the strength k_g and a gap of zero, and `backlash`,
/// with the strength H and the shape k_g. Further shapes are b_g and of a force source, whose M is
/// that of motor and arm together, J_m and, unless it is free, M. For a transmission with a gap of
/// zero `backlash`, with the strength H alone. None for a soft_transmission, or where the scales
/// tell no mass and no stroke.
std::vector<Hypothesis> transmission_hypotheses(const Job& job, const SearchScales& scales);

/// Changes the job's rigid transmission into one with backlash. Where a force source has the
/// armature inertia J_m, kg m^2, the free M and the axis' own become that of the arm alone.
void give_backlash(Job& job, double J_m);

/// Keeps a free k_g of a job below the stiffness at which motor and arm swing with half the
/// sampling frequency of the densest recording that is fitted. What swings faster does not show: it
/// stands for small errors of other kinds, and costs a simulation steps as short.
void limit_stiffness(Job& job);

/// What the arm's mass M of a fitted model lacks of the M of the declared job: the motor's part,
/// kg, where the model has backlash and the job, driven by a force source, is rigid. Else zero.
double mass_of_motor(const Structure& declared, const Model<double>& fitted);

}  // namespace axisfit
