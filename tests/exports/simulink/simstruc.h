/* What an exported S-function uses of Simulink's header of this name, declared anew: so much that
 * it compiles where there is no Simulink, with the mex.h of Octave. */
#ifndef SIMSTRUC_H
#define SIMSTRUC_H

#include "mex.h"

typedef int int_T;
typedef double real_T;
typedef int DTypeId;
typedef struct SimStruct SimStruct;
enum { SS_DOUBLE };

int_T ssGetNumSFcnParams(const SimStruct *S);
int_T ssGetSFcnParamsCount(const SimStruct *S);
void ssSetNumSFcnParams(SimStruct *S, int_T n);
const mxArray *ssGetSFcnParam(const SimStruct *S, int_T i);
int_T ssSetNumInputPorts(SimStruct *S, int_T n);
void ssSetInputPortWidth(SimStruct *S, int_T port, int_T width);
void ssSetInputPortRequiredContiguous(SimStruct *S, int_T port, int_T is);
void ssSetInputPortDirectFeedThrough(SimStruct *S, int_T port, int_T is);
const real_T *ssGetInputPortRealSignal(SimStruct *S, int_T port);
int_T ssSetNumOutputPorts(SimStruct *S, int_T n);
void ssSetOutputPortWidth(SimStruct *S, int_T port, int_T width);
real_T *ssGetOutputPortRealSignal(SimStruct *S, int_T port);
void ssSetNumSampleTimes(SimStruct *S, int_T n);
void ssSetSampleTime(SimStruct *S, int_T i, real_T t);
void ssSetOffsetTime(SimStruct *S, int_T i, real_T t);
void ssSetNumDWork(SimStruct *S, int_T n);
void ssSetDWorkWidth(SimStruct *S, int_T i, int_T width);
void ssSetDWorkDataType(SimStruct *S, int_T i, DTypeId type);
void *ssGetDWork(SimStruct *S, int_T i);

#endif
