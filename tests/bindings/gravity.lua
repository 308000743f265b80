-- LuaJIT's ffi.   luajit gravity.lua libdyn.so robot.urdf
local ffi = require "ffi"
ffi.cdef [[int dyn_model_load(const char*, const void*, void**); int dyn_data_new(const void*, uint32_t, void**); int dyn_model_nv(const void*);
           int dyn_gravity_torque(const void*, void*, const double*, double*); const char* dyn_last_error(void);]]
local dyn, model, data, tau = ffi.load(arg[1]), ffi.new "void*[1]", ffi.new "void*[1]", ffi.new "double[2]"
assert(dyn.dyn_model_load(arg[2], nil, model) == 0 and dyn.dyn_data_new(model[0], 0, data) == 0, ffi.string(dyn.dyn_last_error()))
assert(dyn.dyn_gravity_torque(model[0], data[0], ffi.new("double[2]", 0.3, -0.4), tau) == 0, ffi.string(dyn.dyn_last_error()))
print(string.format("nv %d, gravity %.9f %.9f", dyn.dyn_model_nv(model[0]), tau[0], tau[1]))
