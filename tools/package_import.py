# What a package's Python part must do: prints the folder of its module, a check sum of the estimator's numbers, the time of the import.
import hashlib
import os
import sys
import time

begin_s = time.perf_counter()
import pneuservo

import_s = time.perf_counter() - begin_s
import numpy

config = pneuservo.Config(sys.argv[1])
u_V = numpy.sin(numpy.arange(500) * config.period_s * 6.0)
seen = pneuservo.Plant(config).run(u_V)
estimate = pneuservo.Estimator(config).run(seen["p1_port_Pa"], seen["p2_port_Pa"], seen["x_m"], seen["v_mps"], u_V)
numbers = hashlib.sha256(estimate["p1_estimated_Pa"].tobytes()).hexdigest()[:16]
print(os.path.basename(os.path.dirname(pneuservo._core.__file__)), numbers, f"{import_s:.3f}", pneuservo.__version__)
