# Perl's FFI::Platypus.   perl gravity.pl libdyn.so robot.urdf
use strict;
use FFI::Platypus 1.00;
my $ffi = FFI::Platypus->new(api => 1, lib => $ARGV[0]);
$ffi->attach(dyn_model_load => ["string", "opaque", "opaque*"] => "int"), $ffi->attach(dyn_data_new => ["opaque", "uint32", "opaque*"] => "int");
$ffi->attach(dyn_gravity_torque => ["opaque", "opaque", "double[2]", "double[2]"] => "int"), $ffi->attach(dyn_model_nv => ["opaque"] => "int"), $ffi->attach(dyn_last_error => [] => "string");
my ($model, $data, @tau) = (undef, undef, 0, 0);
dyn_model_load($ARGV[1], undef, \$model) == 0 && dyn_data_new($model, 0, \$data) == 0 or die dyn_last_error();
dyn_gravity_torque($model, $data, [0.3, -0.4], \@tau) == 0 or die dyn_last_error();
printf "nv %d, gravity %.9f %.9f\n", dyn_model_nv($model), @tau;
