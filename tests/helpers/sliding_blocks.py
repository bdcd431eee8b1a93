"""A structure of six irregular blocks on a turning support. The inset changes its prediction three times as much as its bound."""

SLIDING = """
accuracy = 0.01
[[block]]
name = "b0"
density = 4904.01
prism = {profile=[[3.112685, 1.885107], [3.200664, 2.680737], [1.575761, 2.680737], [1.370208, 1.257479]], y=[0, 0.89214]}
[[block]]
name = "b1"
density = 5572.84
prism = {profile=[[0.087979, 0.79563], [1.212546, 1.200691], [2.463999, 0.0], [0.0, 0.0]], y=[0, 0.89214]}
[[block]]
name = "b2"
density = 562.187452
prism = {profile=[[1.459073, 1.872784], [1.370208, 1.257479], [0.087979, 0.79563], [0.203155, 1.837214]], y=[0, 0.89214]}
[[block]]
name = "b3"
density = 1291.72
prism = {profile=[[1.575761, 2.680737], [0.296429, 2.680737], [0.203155, 1.837214], [1.459073, 1.872784]], y=[0, 0.89214]}
[[block]]
name = "b4"
density = 308.456691
prism = {profile=[[1.382658, 1.037479], [3.002347, 0.887268], [2.904235, 0.0], [2.463999, 0.0]], y=[0, 0.89214]}
[[block]]
name = "b5"
density = 6454.21
prism = {profile=[[3.002347, 0.887268], [3.112685, 1.885107], [1.212546, 1.200691], [1.382658, 1.037479]], y=[0, 0.89214]}
[[block]]
name = "g0"
role = "support"
density = 1000.0
prism = {profile=[[-0.2, 0.0], [1.744525, 0.0], [1.744525, -0.3], [-0.2, -0.3]], y=[0, 0.89214]}
[[block]]
name = "g1"
role = "fixed"
density = 1000.0
prism = {profile=[[1.744525, -0.3], [2.208996, -0.3], [2.208996, 0.0], [1.744525, 0.0]], y=[0, 0.89214]}
[[block]]
name = "g2"
role = "fixed"
density = 1000.0
prism = {profile=[[2.208996, -0.3], [3.104235, -0.3], [3.104235, 0.0], [2.208996, 0.0]], y=[0, 0.89214]}
[[friction]]
between = ["b5", "b4"]
friction = 0.259808
[[friction]]
between = ["g1", "b1"]
friction = 0.198591
[[load]]
name = "l0"
blocks = ["b2"]
at = [0.690414, 0.44607, 1.498353]
mass = 3933.46
[[load]]
name = "l1"
blocks = ["b3"]
at = [0.827162, 0.44607, 1.921729]
force = [2804.81, 0.0, -5431.97]
[joint]
friction = 0.83809
inset = 0.005
[effects]
[settlement]
axis = [0.0, 2.0, 0.0]
point = [-1.048986, 0.752001, 0.897647]
"""
