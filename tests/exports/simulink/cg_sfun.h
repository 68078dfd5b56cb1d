/* Here the standard file of S-functions would take over: what it calls, and so is used. */
static void (*const kCalled[])(SimStruct *) = {mdlInitializeSizes, mdlInitializeSampleTimes,
                                               mdlInitializeConditions, mdlTerminate};
static void (*const kCalledWithTask[])(SimStruct *, int_T) = {mdlOutputs, mdlUpdate};
const void *used_by_simulink[2] = {kCalled, kCalledWithTask};
