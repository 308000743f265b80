// Rust's extern "C".   rustc gravity.rs -L LIBDIR -l dyn && ./gravity robot.urdf
use std::{ffi::{c_char, c_int, c_void, CStr, CString}, ptr::{null, null_mut}};
extern "C" {
    fn dyn_model_load(path: *const c_char, options: *const c_void, model: *mut *mut c_void) -> c_int;
    fn dyn_data_new(model: *const c_void, parts: u32, data: *mut *mut c_void) -> c_int;
    fn dyn_gravity_torque(model: *const c_void, data: *mut c_void, q: *const f64, tau: *mut f64) -> c_int;
    fn dyn_model_nv(model: *const c_void) -> c_int;
    fn dyn_last_error() -> *const c_char;
}
fn main() {
    let path = CString::new(std::env::args().nth(1).unwrap()).unwrap();
    let (mut model, mut data, mut tau) = (null_mut(), null_mut(), [0.0; 2]);
    unsafe {
        let good = dyn_model_load(path.as_ptr(), null(), &mut model) == 0 && dyn_data_new(model, 0, &mut data) == 0
            && dyn_gravity_torque(model, data, [0.3, -0.4].as_ptr(), tau.as_mut_ptr()) == 0;
        assert!(good, "{}", CStr::from_ptr(dyn_last_error()).to_str().unwrap());
        println!("nv {}, gravity {:.9} {:.9}", dyn_model_nv(model), tau[0], tau[1]);
    }
}
