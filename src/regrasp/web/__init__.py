"""Drawing in the browser: the modules in JavaScript that pages, the explorer and its widget are made of."""
