// Go's cgo, which reads dyn.h itself.   CGO_CFLAGS=-I... CGO_LDFLAGS="-L... -ldyn" go run gravity.go robot.urdf
package main

// #include <dyn.h>
import "C"
import (
	"fmt"
	"os"
)

func main() {
	var model *C.dynModel
	var data *C.dynData
	q, tau := [2]C.double{0.3, -0.4}, [2]C.double{}
	if C.dyn_model_load(C.CString(os.Args[1]), nil, &model) != 0 || C.dyn_data_new(model, 0, &data) != 0 || C.dyn_gravity_torque(model, data, &q[0], &tau[0]) != 0 {
		panic(C.GoString(C.dyn_last_error()))
	}
	fmt.Printf("nv %d, gravity %.9f %.9f\n", C.dyn_model_nv(model), tau[0], tau[1])
}
