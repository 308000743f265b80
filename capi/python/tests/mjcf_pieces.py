"""Pieces of MJCF files that several tests put together."""

BODY = '<body name="a"><joint name="j"/><geom size=".1"/></body>'
HINGE = '<worldbody><body name="b"><joint name="j" axis="0 1 0"/><geom size=".1" pos=".5 0 0"/></body></worldbody>'
BOXES = '<worldbody><body name="a"><joint name="ja"/><geom size=".1"/></body><body name="b" pos="0 0 1"><joint name="jb"/><geom size=".1"/></body></worldbody>'
