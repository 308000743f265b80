# Ruby's Fiddle.   ruby gravity.rb libdyn.so robot.urdf
require "fiddle/import"
module Dyn
  extend Fiddle::Importer
  dlload ARGV[0]
  extern "int dyn_model_load(const char*, void*, void*)"
  extern "int dyn_data_new(void*, unsigned int, void*)"
  extern "int dyn_model_nv(void*)"
  extern "int dyn_gravity_torque(void*, void*, void*, void*)"
  extern "char* dyn_last_error()"
end
out, tau = Array.new(2) { Fiddle::Pointer.malloc(Fiddle::SIZEOF_VOIDP, Fiddle::RUBY_FREE) }, "\0" * 16
Dyn.dyn_model_load(ARGV[1], nil, out[0]) == 0 && Dyn.dyn_data_new(out[0].ptr, 0, out[1]) == 0 or abort Dyn.dyn_last_error.to_s
Dyn.dyn_gravity_torque(out[0].ptr, out[1].ptr, [0.3, -0.4].pack("d2"), tau) == 0 or abort Dyn.dyn_last_error.to_s
printf("nv %d, gravity %.9f %.9f\n", Dyn.dyn_model_nv(out[0].ptr), *tau.unpack("d2"))
