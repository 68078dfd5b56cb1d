// axisfit as a library: jobs and recordings, run(), and what it returns.
#pragma once

#include "fit/run.h"
#include "io/config/job_file.h"
#include "io/recording/csv.h"
#include "report/text/report_text.h"
#include "sim/rig.h"
