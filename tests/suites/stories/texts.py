"""Stories the tests play."""

SHARED_SECRET = """\
1 Nora, Tom and Ida entered the attic.
2 The lantern is in the grey_trunk.
3 Tom likes the blue_jar.
4 Nora moved the lantern to the tin_box.
5 Nora exited the attic.
6 Tom moved the lantern to the oak_cabinet.
7 Tom exited the attic.
8 Ida made no movements and stayed in the attic for 1 minute.
9 Ida moved the lantern to the grey_trunk.
10 Ida exited the attic.
11 Nora, Tom and Ida entered the waiting_room.
12 Ida and Nora entered the cellar.
13 The compass is in the tin_box.
14 Ida moved the compass to the crate.
15 Ida exited the cellar.
16 Nora moved the compass to the tin_box.
17 Nora exited the cellar.
18 Ida and Nora entered the waiting_room.
"""
"""Two rooms; both have a tin_box."""

COMING_BACK = """\
Bo entered the study.
Cy entered the study.
The apple is in the basket.
The basket is in the study.
Cy left the study.
Bo moved the apple to the drawer.
The drawer is in the study.
Cy entered the study.
Bo exited the study.
Cy moved the apple to the basket.
Phone rang.
"""
"""ToMi's wording; Cy sees on entering where the apple went."""
