"""A stored run in the Exudyn renderer: press, joints enlarged, stills, films and a window."""
